// Elimination order of a small graph by exact minimum degree, on bit sets.
#pragma once

#include <array>

#include "kernels/base/types.hpp"

namespace planish {

inline constexpr Index kSmallGraph = 512;  ///< vertices at most
using VertexSet = std::array<std::uint64_t, kSmallGraph / 64>;

/// Orders the first `inner` of n vertices; those behind them are eliminated later, but count as neighbours.
///   adjacent [n] sets of neighbours, overwritten;   order [inner] out
/// Pre: n <= kSmallGraph.   Cost: O(inner^2 + the factor's entries * n / 64).
void minimum_degree(Index inner, Out<VertexSet> adjacent, Out<Index> order);

}  // namespace planish
