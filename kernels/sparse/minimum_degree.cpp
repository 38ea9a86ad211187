#include "kernels/sparse/minimum_degree.hpp"

#include <bit>

#include "kernels/base/lanes.hpp"

namespace planish {
namespace {

PLANISH_INLINE void erase(VertexSet& set, Index v) { set[v / 64] &= ~(std::uint64_t{1} << (v % 64)); }

PLANISH_INLINE Index count(const VertexSet& set, Index words) {
  int sum = 0;
  for (Index w = 0; w < words; ++w) sum += std::popcount(set[w]);
  return static_cast<Index>(sum);
}

template <class Body>
PLANISH_INLINE void for_members(const VertexSet& set, Index words, Body&& body) {
  for (Index w = 0; w < words; ++w) {
    for (std::uint64_t bits = set[w]; bits != 0; bits &= bits - 1)
      body(static_cast<Index>(64 * w + std::countr_zero(bits)));
  }
}

}  // namespace

PLANISH_CLONES void minimum_degree(Index inner, Out<VertexSet> adjacent, Out<Index> order) {
  const Index words = (static_cast<Index>(adjacent.size()) + 63) / 64;
  std::array<Index, kSmallGraph> degree, left;
  for (Index v = 0; v < inner; ++v) {
    degree[v] = count(adjacent[v], words);
    left[v] = v;
  }
  for (Index done = 0; done < inner; ++done) {
    Index at = done;
    for (Index k = done + 1; k < inner; ++k) {
      if (degree[left[k]] < degree[left[at]]) at = k;
    }
    const Index v = left[at];
    left[at] = left[done];
    order[done] = v;
    // Its neighbours become neighbours of one another.
    const VertexSet around = adjacent[v];
    for_members(around, words, [&](Index u) {
      for (Index w = 0; w < words; ++w) adjacent[u][w] |= around[w];
      erase(adjacent[u], u);
      erase(adjacent[u], v);
      if (u < inner) degree[u] = count(adjacent[u], words);
    });
  }
}

}  // namespace planish
