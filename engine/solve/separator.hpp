// Vertex separators: what is taken out of a graph for two parts to have no edge between them.
#pragma once

#include <array>

#include "engine/solve/graph_levels.hpp"

namespace planish {

inline constexpr std::uint8_t kSeparator = 2;  ///< sides are 0 and 1

struct Separator {
  std::vector<std::uint8_t> side;     ///< [n] 0, 1 or kSeparator; no edge joins 0 and 1
  std::array<Offset, 3> weight = {};  ///< of the sides and of the separator
};

/// A light separator with at most 3/5 of the weight on a side, where there is one: coarsened, split where it is small, and
/// refined on the way back. Deterministic.
/// Cost: O(edges).   Ref: Karypis and Kumar 1998; refinement after Fiduccia and Mattheyses 1982 on vertices.
Separator find_separator(const Graph& graph);
/// The same for the finest graph; coarser ones that are missing are added, for its parts.
Separator find_separator(GraphLevels& levels);

/// Moves vertices between separator and sides while that makes the separator lighter, or heavier in between.
void refine_separator(const Graph& graph, Separator& separator);

}  // namespace planish
