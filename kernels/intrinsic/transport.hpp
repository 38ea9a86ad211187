// Unfolding from one triangle to its neighbour.
#pragma once

#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// Direction of half-edge i (0, 1, 2) in its triangle's reference frame, radians in (-pi, pi].
inline double edge_direction(const RestFrame& f, Index i) {
  if (i == 0) return 0;
  return i == 1 ? std::atan2(f.y2, f.x2 - f.x1) : std::atan2(-f.y2, -f.x2);
}

/// Angle of the neighbour's frame after an isometric unfolding across half-edge c with twin c_twin, for a
/// frame at angle theta; radians, not reduced.
/// Ref: DESIGN 3.1, w_e = 0.
inline double unfold_angle(double theta, Index c, Index c_twin, In<RestFrame> frame) {
  return theta + edge_direction(frame[c / 3], c % 3) - edge_direction(frame[c_twin / 3], c_twin % 3) - kPi;
}

/// Angle reduced to (-pi, pi].
inline double reduce_angle(double angle) {
  const double r = std::remainder(angle, 2 * kPi);
  return r <= -kPi ? r + 2 * kPi : r;
}

}  // namespace planish
