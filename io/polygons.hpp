// Faces as files list them, cut into triangles.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "kernels/base/offsets.hpp"

namespace planish {

/// Corners of one face that readers take; ear clipping takes quadratic time.
inline constexpr Offset kMostFaceCorners = 1 << 16;

/// Why no face can have so many corners; empty where it can.
std::string unusable_face(Offset num_corners);

/// Triangles of polygon p are [first_triangle(p), first_triangle(p + 1)): n corners give n - 2 triangles.
inline Index first_triangle(Offsets polygons, Index p) { return polygons.begin[p] - 2 * p; }
inline Index num_triangles(Offsets polygons) { return first_triangle(polygons, polygons.size()); }

/// For every corner of the triangles, the polygon corner it comes from.
///   polygons: corners of each, 3 to kMostFaceCorners;  corner_vertex [corners] in range of position
/// Cost: O(corners) for convex polygons, in parallel.
std::vector<Index> triangulate(const Exec& exec, Offsets polygons, In<Index> corner_vertex,
                               In<Vec3> position);

}  // namespace planish
