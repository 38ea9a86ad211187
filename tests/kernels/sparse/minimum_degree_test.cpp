#include "kernels/sparse/minimum_degree.hpp"

#include <doctest/doctest.h>

#include <set>
#include <vector>

#include "tests/support/shapes.hpp"

using namespace planish;

TEST_CASE(
    "minimum degree: every vertex has the least degree when it is eliminated, halo counted, halo kept") {
  shapes::Random random(41);
  for (const Index n : {1, 5, 64, 65, 130}) {
    for (const Index inner : {n, n - n / 3}) {
      std::vector<std::set<Index>> graph(n);
      for (Index k = 0; k < 2 * n; ++k) {
        const auto a = std::min(n - 1, static_cast<Index>(random.uniform() * n));
        const auto b = std::min(n - 1, static_cast<Index>(random.uniform() * n));
        if (a != b) graph[a].insert(b), graph[b].insert(a);
      }
      std::vector<VertexSet> adjacent(n, VertexSet{});
      for (Index a = 0; a < n; ++a) {
        for (const Index b : graph[a]) adjacent[a][b / 64] |= std::uint64_t{1} << (b % 64);
      }
      std::vector<Index> order(inner);
      minimum_degree(inner, adjacent, order);
      std::set<Index> left;
      for (Index v = 0; v < inner; ++v) left.insert(v);
      for (const Index v : order) {
        REQUIRE(left.count(v) == 1);
        for (const Index u : left) CHECK(graph[v].size() <= graph[u].size());
        left.erase(v);
        for (const Index u : graph[v]) {
          graph[u].insert(graph[v].begin(), graph[v].end());
          graph[u].erase(u);
          graph[u].erase(v);
        }
      }
      CHECK(left.empty());
    }
  }
}
