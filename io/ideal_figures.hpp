// The straight line and the circle that lie nearest to points, and what a page shows of them.
#pragma once

#include <optional>
#include <vector>

#include "io/canvas.hpp"

namespace planish {

struct FittedLine {
  Vec2 point;                  ///< mean of the points
  Vec2 direction;              ///< of unit length
  double first = 0, last = 0;  ///< the points' projections lie at point + s direction, s in [first, last]
};

struct FittedCircle {
  Vec2 centre;
  double radius = 0;
};

/// Least squares of the distances to the line.
/// Fails: no line where all points are one.   Cost: O(n).
std::optional<FittedLine> fit_line(In<Vec2> point);

/// Least squares of the distances to the circle.
/// Fails: no circle where the points lie on a line, or as good as on one: a radius beyond 10^4 times their extent.
/// Cost: O(n).   Ref: start by Kasa 1976; Gauss-Newton steps as in Gander, Golub and Strebel 1994.
std::optional<FittedCircle> fit_circle(In<Vec2> point);

/// The part of the line from first - beyond to last + beyond that lies in the box; empty or two points.
std::vector<Vec2> part_inside(const FittedLine& line, double beyond, const PixelBox& box);

/// The arcs of the circle that lie in the box, points at most `step` apart. A whole circle is one arc that ends
/// where it begins.
std::vector<std::vector<Vec2>> parts_inside(const FittedCircle& circle, double step, const PixelBox& box);

}  // namespace planish
