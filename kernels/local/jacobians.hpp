// Jacobians of a piecewise linear map, from reference frames to the uv plane.
#pragma once

#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// Matrix that takes the frame's edges to those of the image z0, z1, z2.
inline Mat2 jacobian(const RestFrame& f, Vec2 z0, Vec2 z1, Vec2 z2) {
  const Vec2 du = (1 / f.x1) * (z1 - z0);
  const Vec2 dv = (1 / f.y2) * ((z2 - z0) - f.x2 * du);
  return {du.x, dv.x, du.y, dv.y};
}

///   frame [T] length;  uv [V] length;  corner_vertex [3 T];  jacobian [T] out, no unit.
void jacobians(Range r, In<RestFrame> frame, In<Vec2> uv, In<Index> corner_vertex, Out<Mat2> jacobian);

}  // namespace planish
