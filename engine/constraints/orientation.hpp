// From bodies without pins to first rotations and the directions of all bodies (DESIGN 3.3).
#pragma once

#include "engine/constraints/branches.hpp"
#include "engine/constraints/closure.hpp"
#include "engine/constraints/near_closure.hpp"
#include "engine/constraints/rotation_problem.hpp"

namespace planish {

struct Orientation {
  std::vector<double> theta;        ///< [T] triangle angles, radians
  double residual = 0;              ///< largest one of any rotation row, radians
  Clusters clusters;                ///< of the bodies
  std::vector<double> angle;        ///< per body: its direction in the plane, radians
  std::vector<double> chosen;       ///< per relation: its angle in the plane, radians
  std::vector<PartedJoint> parted;  ///< joints that cycles of bodies close but for a part of `agreement`
  std::vector<std::uint8_t>
      directed;  ///< per component: 1 where its frame is tied to the u axis or to other components
};

/// Lays bodies out assembly by assembly, solves for the smallest connection whose sectors agree with them, reads off how
/// the assemblies lie to one another, chooses the angles of relations nearest to that, and adds rows that meet them.
/// With Init::Harmonic or Identity no rows are solved: directions are read off those maps.
/// Fails: ConstraintsConflict (angles; joints that do not close; templates that fold); FactorizationFailed,
///        ResidualTooLarge, OutOfMemory.
Result<Orientation> orient(const Exec& exec, const RestSurface& rest, const ConstraintView& view,
                           Compiled compiled, const StartInput& input, Init init);

}  // namespace planish
