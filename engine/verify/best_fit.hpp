// Best fits in closed form, written for the residuals alone: nothing here is shared with what made the map.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish::fit {

Vec2 mean(In<Vec2> points);

/// Of total least squares; runs from the first towards the last point.
struct Line {
  Vec2 centre, direction;
  double along(Vec2 p) const { return dot(direction, p - centre); }
  double distance(Vec2 p) const { return std::abs(cross(direction, p - centre)); }
};
/// Pre: two or more points.
Line line_through(In<Vec2> points);

struct Circle {
  Vec2 centre;
  double radius = 0;
  double distance(Vec2 p) const { return std::abs(norm(p - centre) - radius); }
};
/// Least squares of the distances, by Gauss and Newton from the algebraic circle; radius: given, or found.
/// None where the points determine no circle.   Pre: three or more points.
std::optional<Circle> circle_through(In<Vec2> points, std::optional<double> radius = {});

/// z = target + turn (t - source): the best similarity without reflection from a template to its image.
struct Pose {
  Vec2 source, target, turn;
  double spread = 0;  ///< root mean square distance of the template from its centre
  Vec2 place(Vec2 t) const { return target + multiply(turn, t - source); }
};
/// scale: |turn| where it is given, else free.   Ref: Umeyama 1991, in the plane.
Pose best_pose(In<Vec2> shape, In<Vec2> image, std::optional<double> scale = {});

/// Points as seen across their best-fit plane, every point weighted equally.
struct Projection {
  std::vector<Vec2> image;
  std::vector<double> height;      ///< over the plane
  std::array<double, 3> moment{};  ///< second moments along the axes over the squared size, decreasing
  Vec3 normal;
};
Projection project(In<Vec3> points);

/// Radius of the arc with these chords and this sweep (radians).
double arc_radius(In<double> chord, double sweep);

/// By which the points sweep about a centre, radians, without sign.
double sweep_about(Vec2 centre, In<Vec2> points);

}  // namespace planish::fit
