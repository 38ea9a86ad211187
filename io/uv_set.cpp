#include "io/uv_set.hpp"

#include <atomic>

namespace planish {

bool is_per_vertex(const Exec& exec, In<Index> corner_vertex, In<Vec2> corner_uv, Index num_vertices) {
  // Any corner of a vertex will do: if all agree, the winner of the race does not matter, and if not, no
  // winner makes them agree.
  std::vector<Index> vertex_corner(num_vertices, 0);
  const auto num_corners = static_cast<Index>(corner_vertex.size());
  exec.for_blocks(num_corners, kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) {
      std::atomic_ref(vertex_corner[corner_vertex[c]]).store(c, std::memory_order_relaxed);
    }
  });
  std::atomic<bool> same = true;
  exec.for_blocks(num_corners, kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) {
      if (!(corner_uv[c] == corner_uv[vertex_corner[corner_vertex[c]]])) same = false;
    }
  });
  return same;
}

std::vector<Vec2> uv_of_vertices(In<Index> corner_vertex, In<Vec2> corner_uv, Index num_vertices) {
  std::vector<Vec2> vertex_uv(num_vertices);
  for (std::size_t c = 0; c < corner_vertex.size(); ++c) vertex_uv[corner_vertex[c]] = corner_uv[c];
  return vertex_uv;
}

std::vector<Vec2> uv_of_corners(const Exec& exec, In<Index> corner_vertex, In<Vec2> vertex_uv) {
  std::vector<Vec2> corner_uv(corner_vertex.size());
  exec.for_blocks(static_cast<Index>(corner_vertex.size()), kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) corner_uv[c] = vertex_uv[corner_vertex[c]];
  });
  return corner_uv;
}

}  // namespace planish
