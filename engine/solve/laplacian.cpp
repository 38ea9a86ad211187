#include "engine/solve/laplacian.hpp"

#include <algorithm>

#include "engine/solve/columns.hpp"

namespace planish {
namespace {

/// Neighbours of v across each edge once, with the half-edge that names the edge.
template <class Visit>
void for_each_edge(Index v, In<Index> corner_vertex, const Topology& topology, Visit&& visit) {
  for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
    visit(corner_vertex[next_corner(c)], c);
    const Index arriving = previous_corner(c);
    if (topology.corner_twin[arriving] == kNone) visit(corner_vertex[arriving], arriving);
  }
}

/// Appends the edges of vertex v, which belongs to node j, to the column of j.
void add_vertex(Index v, Index j, In<Index> corner_vertex, const Topology& topology, In<Index> node,
                const EdgeWeight& weight, std::vector<Entry>& column) {
  for_each_edge(v, corner_vertex, topology, [&](Index u, Index c) {
    const Index i = node[u];
    if (i == j) return;
    const double w = weight(c);
    column.front().value += w;
    if (i > j) column.push_back({i, -w});
  });
}

}  // namespace

SymmetricMatrix quotient_laplacian(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                   In<Index> node, Index num_nodes, const EdgeWeight& weight) {
  const auto num_vertices = static_cast<Index>(node.size());
  std::vector<std::vector<Index>> members(std::max(0, num_nodes - num_vertices));  // of the merged nodes
  for (Index v = 0; v < num_vertices; ++v) {
    if (node[v] >= num_vertices) members[node[v] - num_vertices].push_back(v);
  }
  return gather_columns(exec, num_nodes, [&](Range r, ColumnSink& sink) {
    std::vector<Entry> column;
    for (Index j = r.begin; j < r.end; ++j) {
      column.assign(1, {j, 0});
      if (j >= num_vertices) {
        for (const Index v : members[j - num_vertices]) {
          add_vertex(v, j, corner_vertex, topology, node, weight, column);
        }
      } else if (node[j] == j) {
        add_vertex(j, j, corner_vertex, topology, node, weight, column);
      } else {
        column.front().value = 1;
      }
      merge_rows(column);
      sink.add(column);
    }
  });
}

SymmetricMatrix held_laplacian(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                               In<std::uint8_t> held, const EdgeWeight& weight) {
  return gather_columns(exec, static_cast<Index>(held.size()), [&](Range r, ColumnSink& sink) {
    std::vector<Entry> column;
    for (Index v = r.begin; v < r.end; ++v) {
      column.assign(1, {v, 0});
      for_each_edge(v, corner_vertex, topology, [&](Index u, Index c) {
        const double w = weight(c);
        column.front().value += w;
        if (u > v) column.push_back({u, held[u] || held[v] ? 0 : -w});
      });
      if (held[v]) column.front().value = 1;
      merge_rows(column);
      sink.add(column);
    }
  });
}

SymmetricMatrix vertex_laplacian(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                 In<std::uint8_t> fixed, const EdgeWeight& weight) {
  std::vector<Index> node(fixed.size());
  for (std::size_t v = 0; v < fixed.size(); ++v) node[v] = fixed[v] ? kNone : static_cast<Index>(v);
  return quotient_laplacian(exec, corner_vertex, topology, node, static_cast<Index>(node.size()), weight);
}

}  // namespace planish
