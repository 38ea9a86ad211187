// Graphs of sparse matrices as nested dissection sees them, coarsened by aggregates.
#pragma once

#include <vector>

#include "kernels/base/offsets.hpp"

namespace planish {

/// Undirected graph: neighbours of vertex v are neighbour[begin[v], begin[v + 1]), v not among them.
struct Graph {
  std::vector<Index> begin{0}, neighbour;
  std::vector<Index> edge_weight;  ///< of each neighbour: how many edges it stands for; empty: one each
  std::vector<Index> weight;       ///< of each vertex: how many it stands for
  Index size() const { return static_cast<Index>(weight.size()); }
  In<Index> neighbours(Index v) const {
    return In<Index>(neighbour).subspan(begin[v], begin[v + 1] - begin[v]);
  }
};

/// A coarser graph whose vertices stand for groups: in large graphs whole neighbourhoods, an eighth of the vertices on a
/// triangle mesh; in small ones up to three vertices along heavy edges.
///   seed: 0 visits vertices in their order, others give other groups;   group [n] out: of each vertex
/// Ref: Vaněk, Mandel and Brezina 1996, section 5.1; Karypis and Kumar 1998 (heavy edges).   Cost: O(edges).
Graph coarsen(const Graph& graph, std::uint64_t seed, std::vector<Index>& group);

/// The part of a graph with part[v] == which, its vertices in the same order.
///   local [n] scratch;   vertex out: of the whole, by vertex of the part
Graph part_of(const Graph& graph, In<std::uint8_t> part, std::uint8_t which, std::vector<Index>& local,
              std::vector<Index>& vertex);

}  // namespace planish
