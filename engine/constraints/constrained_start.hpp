// From an oriented constraint system to the DOF maps and rotations that the solve begins with.
#pragma once

#include "engine/constraints/system.hpp"
#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"
#include "engine/workpiece.hpp"

namespace planish {

struct ConstrainedStart {
  std::unique_ptr<DofMap> first;  ///< of the first global step: directions as the first rotations have them
  std::unique_ptr<DofMap> free;   ///< of the further ones; none where directions are kept
  std::vector<Vec2> rotation;     ///< [T]

  DofMap& last() const { return free ? *free : *first; }
};

/// Decides what the first rotations leave open: templates that the surface lets lie either way round are tried both ways,
/// components that several pins hold are turned onto them.
/// global: of the system's nodes.   Fails: ConstraintsConflict, ConstraintInvalid (more unknowns beside the sparse part than
/// fit); Cancelled, OutOfMemory, FactorizationFailed.
Result<ConstrainedStart> constrained_start(const Exec& exec, const Workpiece& piece, ConstraintSystem& system,
                                           GlobalPhase& global, const FlattenOptions& options,
                                           const Monitor& monitor);

/// Refuses more free scales, directions and places than a dense border can hold.
Result<void> check_border(const DofMap& dof);

}  // namespace planish
