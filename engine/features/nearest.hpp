// Distances of a point to segments and triangles.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

bool is_finite_point(Vec3 p);

/// Squared distance of p to the segment a b (a = b: to the point).
double squared_distance_to_segment(Vec3 p, Vec3 a, Vec3 b);

/// Squared distance of p to the triangle a b c; a needle counts as its edges.
double squared_distance_to_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

/// At most the squared distance of p to anything inside the triangle's box: cheap, to pass over most triangles.
double squared_distance_to_box(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

/// Lexicographic order of positions: a direction that does not depend on the numbers of vertices.
bool comes_before(Vec3 a, Vec3 b);

}  // namespace planish
