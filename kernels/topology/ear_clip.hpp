// One polygon into triangles, concave ones too.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// Scratch that ear_clip needs for a polygon of n corners.
inline constexpr Offset ear_clip_scratch(Offset n) { return 6 * n; }

/// Cuts a polygon into n - 2 triangles whose corners are corners of the polygon, in its orientation.
///   polygon  [n] points in order, n >= 3, about in one plane; the first point is not repeated at the end
///   triangle [3 (n - 2)] out: numbers of corners, 0 <= i < n
///   scratch  [ear_clip_scratch(n)]
/// Works in the plane of the Newell normal, with the coordinate dropped along which the normal is longest.
/// Convex polygons become the fan of corner 0. Polygons that cross themselves or have no area give n - 2
/// triangles too, some of them overlapping or degenerate. Fails: never.
/// Cost: O(n (1 + r)) for r reflex
/// corners.
/// Ref: O'Rourke, Computational Geometry in C, 1998, 1.4 (only the neighbours of a cut ear change
/// their state).
void ear_clip(In<Vec3> polygon, Out<Index> triangle, Out<Index> scratch);

}  // namespace planish
