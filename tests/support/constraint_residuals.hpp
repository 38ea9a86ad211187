// How far a map is from meeting constraints, measured anew: from the mesh and the coordinates alone.
#pragma once

#include <string>
#include <vector>

#include "engine/model/flattening.hpp"
#include "tests/support/random_constraints.hpp"

namespace planish {

struct MeasuredResidual {
  std::string name;
  double residual =
      0;  ///< lengths against the feature's size, angles in degrees, pins against the map's size
  bool is_angle = false;
};

/// outcome: only the templates of regions that do not unroll and of closed geodesic curves are taken from it.
std::vector<MeasuredResidual> measure_residuals(const ConstrainedCase& c, In<Vec2> uv,
                                                const std::vector<ConstraintOutcome>& outcome);

/// Second singular value of centred points over the first one: 0 on a line.
double straightness(In<Vec3> point);

}  // namespace planish
