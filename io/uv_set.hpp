// Parameterizations on their way between vertices and corners.
#pragma once

#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// True when all corners of a vertex have the same uv, at every vertex.
/// Cost: O(corners), in parallel.
bool is_per_vertex(const Exec& exec, In<Index> corner_vertex, In<Vec2> corner_uv, Index num_vertices);

/// [V] uv of the corners of each vertex; 0 0 where it has none. Call only where is_per_vertex().
std::vector<Vec2> uv_of_vertices(In<Index> corner_vertex, In<Vec2> corner_uv, Index num_vertices);

/// [3 T] from [V].
std::vector<Vec2> uv_of_corners(const Exec& exec, In<Index> corner_vertex, In<Vec2> vertex_uv);

}  // namespace planish
