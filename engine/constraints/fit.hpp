// Best-fit planes, lines and circles of points.
#pragma once

#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// Plane through the mean of points in space; its axes are right-handed: first x second = normal.
struct FittedPlane {
  Vec3 mean, first, second, normal;
  double spread[3] = {};  ///< singular values of the centred points, largest first
  double farthest = 0;    ///< of the points from the plane
};

/// Each point weighs the same; the normal is the direction of the smallest singular value.   Cost: O(n).
FittedPlane fit_plane(In<Vec3> point);

/// The plane's axes turned about the first one, so that the normal is the part of `towards` across it: for points that
/// are nearly on a line.
void turn_towards(FittedPlane& plane, In<Vec3> point, Vec3 towards);

inline Vec2 in_plane(const FittedPlane& plane, Vec3 p) {
  return {dot(p - plane.mean, plane.first), dot(p - plane.mean, plane.second)};
}

struct BestCircle {
  Vec2 centre;
  double radius = 0;  ///< infinite where the points are on a line
};

/// Least squares of the distances: an algebraic fit, then Gauss-Newton steps.   point [n >= 3]
BestCircle best_circle(In<Vec2> point);

/// Mean of points and the unit vector of their best-fit line.
struct BestLine {
  Vec2 mean, direction;
};
BestLine best_line(In<Vec2> point);

/// The similarity z -> p + c t that takes template points t nearest to points z, in the sense of least squares.
struct Placement {
  Vec2 p;
  Vec2 c{1, 0};
  bool operator==(const Placement&) const = default;
};
/// scale: |c| where it is given, or 0 for the best one.   Ref: Procrustes, in complex numbers.
Placement best_placement(In<Vec2> shape, In<Vec2> point, double scale);

}  // namespace planish
