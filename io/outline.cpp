#include "io/outline.hpp"

#include "kernels/base/offsets.hpp"
#include "kernels/topology/corners.hpp"

namespace planish {
namespace {

struct Stars {
  std::vector<Index> begin;
  std::vector<Index> corner;
};

/// Items grouped by vertex, in ascending order within each group.
template <class VertexOf>
Stars group_by_vertex(Index num_items, Index num_vertices, VertexOf&& vertex_of) {
  std::vector<Index> count(num_vertices, 0);
  for (Index i = 0; i < num_items; ++i) ++count[vertex_of(i)];
  Stars stars{exclusive_scan(count), std::vector<Index>(num_items)};
  std::vector<Index> place(stars.begin.begin(), stars.begin.end() - 1);
  for (Index i = 0; i < num_items; ++i) stars.corner[place[vertex_of(i)]++] = i;
  return stars;
}

/// Follows boundary half-edges from end to start; at a vertex with several of them takes the first that is
/// unused.
std::vector<std::vector<Index>> chain_boundary(In<Index> corner_vertex, Index num_vertices,
                                               In<Index> border) {
  const Stars leaving = group_by_vertex(static_cast<Index>(border.size()), num_vertices,
                                        [&](Index i) { return corner_vertex[border[i]]; });
  std::vector<Index> next(leaving.begin.begin(), leaving.begin.end() - 1);  // first unused of each vertex
  std::vector<std::vector<Index>> chains;
  for (const Index start : border) {
    Index v = corner_vertex[start];
    if (next[v] == leaving.begin[v + 1]) continue;
    std::vector<Index>& chain = chains.emplace_back(1, v);
    while (next[v] < leaving.begin[v + 1]) {
      v = corner_vertex[next_corner(border[leaving.corner[next[v]++]])];
      chain.push_back(v);
    }
  }
  return chains;
}

}  // namespace

Outline find_outline(const Exec& exec, In<Index> corner_vertex, Index num_vertices) {
  const auto num_corners = static_cast<Index>(corner_vertex.size());
  const Stars stars = group_by_vertex(num_corners, num_vertices, [&](Index c) { return corner_vertex[c]; });
  Outline outline;
  outline.twin.resize(num_corners);
  std::vector<EdgeKind> kind(num_corners);
  exec.for_blocks(num_corners, kBlock, [&](Index, Range r) {
    find_twins(r, corner_vertex, {stars.begin}, stars.corner, outline.twin, kind);
  });
  std::vector<Index> border;
  for (Index c = 0; c < num_corners; ++c) {
    if (kind[c] == EdgeKind::Boundary) {
      border.push_back(c);
    } else if (c < outline.twin[c] || outline.twin[c] == kNone) {
      outline.inner.push_back(c);
    }
  }
  outline.boundary = chain_boundary(corner_vertex, num_vertices, border);
  return outline;
}

}  // namespace planish
