// A point that must not reach a segment: their distance with its derivatives, and when they meet.
#pragma once

#include <array>

#include "kernels/base/types.hpp"

namespace planish {

/// Distance of a point from a segment and its derivatives with respect to the point and the segment's ends (in this order),
/// all of them combinations of two unit vectors: the gradient with respect to corner i is share[i] * away, the second
/// derivatives are
///   -distance / length^2 spin[i] spin[j] away away^T - spin[i] share[j] / length (away along^T) - the same transposed,
/// or share[i] share[j] / distance along along^T where an end is nearest.
struct SegmentDistance {
  double distance = 0, length = 0;
  Vec2 away, along;  ///< from the nearest point to the point; across it
  std::array<double, 3> share = {};
  bool at_end = false;
};

/// Pre: the segment has a length, the point is not on it.
SegmentDistance segment_distance(Vec2 point, Vec2 a, Vec2 b);

/// Second derivatives of f(distance), f' = slope <= 0 and f'' = curvature >= 0, with respect to the three corners, moved by a
/// share of the way towards a positive semidefinite matrix: 0 as they are, 1 positive semidefinite.
std::array<std::array<Mat2, 3>, 3> contact_hessian(const SegmentDistance& d, double slope, double curvature,
                                                   double projection);

/// Least t > 0 at which the point reaches the segment when all three move along straight lines; kInfinity where it never does.
/// Pre: apart at 0.
double first_contact(const std::array<Vec2, 3>& corner, const std::array<Vec2, 3>& step);

}  // namespace planish
