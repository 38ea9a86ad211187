// A graph with coarser ones, kept for its parts.
#pragma once

#include "engine/solve/graph.hpp"

namespace planish {

/// graph[0], and as far as they were made coarser ones: vertex v of graph[l] is in group[l][v], a vertex of graph[l + 1].
struct GraphLevels {
  std::vector<Graph> graph;
  std::vector<std::vector<Index>> group;
};

/// Levels of at most this size are left out of parts: to coarsen their finer graph anew costs little.
inline constexpr Index kLeastLevel = 500;

/// The part of the finest graph with part[v] == which, and the groups of its vertices without their members outside. Groups
/// keep their edges though some of what these stood for is outside: no edge of a finer graph is missing in a coarser one.
///   vertex out: of the whole's finest graph, by vertex of the part's
/// Cost: O(edges).
GraphLevels part_of(const GraphLevels& whole, In<std::uint8_t> part, std::uint8_t which,
                    std::vector<Index>& vertex);

}  // namespace planish
