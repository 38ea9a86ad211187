// Reference frames, areas and corner angles of triangles in space.
#pragma once

#include <array>

#include "kernels/base/types.hpp"

namespace planish {

/// Isometric copy of a triangle in the plane: corner 0 at the origin, corner 1 at (x1, 0), corner 2 at (x2,
/// y2), y2 >= 0.
struct RestFrame {
  double x1 = 0, x2 = 0, y2 = 0;
};

inline RestFrame rest_frame(Vec3 p0, Vec3 p1, Vec3 p2) {
  const Vec3 e1 = p1 - p0, e2 = p2 - p0;
  const double x1 = norm(e1);
  return {x1, dot(e1, e2) / x1, norm(cross(e1, e2)) / x1};
}

/// The vectors of half-edges 0 -> 1, 1 -> 2, 2 -> 0.
inline std::array<Vec2, 3> edge_vectors(const RestFrame& f) {
  return {Vec2{f.x1, 0}, Vec2{f.x2 - f.x1, f.y2}, Vec2{-f.x2, -f.y2}};
}

inline double area(const RestFrame& f) { return 0.5 * f.x1 * f.y2; }

/// Angles at the three corners, in [0, pi]; they sum to pi.
inline std::array<double, 3> corner_angles(const RestFrame& f) {
  const double a0 = std::atan2(f.y2, f.x2), a1 = std::atan2(f.y2, f.x1 - f.x2);
  return {a0, a1, kPi - a0 - a1};
}

///   position [V] length;  corner_vertex [3 T];  frame [T] out, length.   Fails: never; NaN where corners 0,
///   1 coincide.
void rest_frames(Range triangles, In<Vec3> position, In<Index> corner_vertex, Out<RestFrame> frame);

///   frame [T] length;  angle [3 T] out, radians.
void corner_angles(Range triangles, In<RestFrame> frame, Out<double> angle);

}  // namespace planish
