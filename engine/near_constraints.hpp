// Where constrained features are to lie in a map that knows nothing of them.
#pragma once

#include "engine/constraints/system.hpp"
#include "engine/solve/overlap_free.hpp"
#include "engine/workpiece.hpp"

namespace planish {

struct NearConstraints {
  std::vector<Vec2> uv;            ///< [V] the map, components moved as pins and directions ask
  std::vector<VertexPlace> place;  ///< of feature vertices and pins: where they meet all constraints
  std::unique_ptr<DofMap> dof;     ///< its poses put them there
};

/// Features in their shapes where they fit the map best.
///   system: in and out, oriented at the map;  uv [V] units of the ordered mesh
/// What the DOF map holds, in components without pins, lies at 0.
/// Fails: ConstraintsConflict where they meet nowhere near this map.
Result<NearConstraints> near_constraints(const Workpiece& piece, ConstraintSystem& system,
                                         std::vector<Vec2> uv);

}  // namespace planish
