#include "engine/solve/fill_reducing_order.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "engine/solve/cholesky_analysis.hpp"
#include "engine/solve/separator.hpp"
#include "tests/support/cholmod_reference.hpp"
#include "tests/support/sparse_cases.hpp"

using namespace planish;

namespace {

/// Edges of a triangulated grid, vertices row by row.
std::set<std::pair<Index, Index>> grid_edges(Index width, Index height, Index first = 0) {
  std::set<std::pair<Index, Index>> edges;
  for (Index y = 0; y < height; ++y) {
    for (Index x = 0; x < width; ++x) {
      const Index v = first + y * width + x;
      if (x > 0) edges.insert({v, v - 1});
      if (y > 0) edges.insert({v, v - width});
      if (x > 0 && y > 0) edges.insert({v, v - width - 1});
    }
  }
  return edges;
}

SymmetricMatrix grid(Index width, Index height) {
  shapes::Random random(51);
  return sparse_cases::from_edges(width * height, grid_edges(width, height), random);
}

bool is_permutation(std::vector<Index> order, Index n) {
  std::sort(order.begin(), order.end());
  std::vector<Index> all(n);
  std::iota(all.begin(), all.end(), 0);
  return order == all;
}

Graph graph_of(Index n, const std::set<std::pair<Index, Index>>& edges) {
  std::vector<std::vector<Index>> around(n);
  for (const auto& [a, b] : edges) around[a].push_back(b), around[b].push_back(a);
  Graph graph;
  for (Index v = 0; v < n; ++v) {
    graph.weight.push_back(1);
    graph.neighbour.insert(graph.neighbour.end(), around[v].begin(), around[v].end());
    graph.begin.push_back(static_cast<Index>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace

TEST_CASE(
    "fill-reducing order: every row once, on grids, paths, forests, stars, cliques, and nothing at all") {
  shapes::Random random(52);
  std::vector<SymmetricMatrix> cases = {
      grid(70, 50), grid(2000, 1), sparse_cases::random_matrix(3000, 1, random),
      sparse_cases::random_matrix(500, 12, random), SymmetricMatrix{{0}, {}, {}}};
  std::set<std::pair<Index, Index>> clique, star;
  for (Index a = 0; a < 400; ++a) {
    for (Index b = 0; b < a; ++b) clique.insert({a, b});
    star.insert({a + 1, 0});
  }
  cases.push_back(sparse_cases::from_edges(400, clique, random));
  cases.push_back(sparse_cases::from_edges(401, star, random));
  cases.push_back(sparse_cases::from_edges(5000, {}, random));
  for (const SymmetricMatrix& matrix : cases) {
    const auto order = fill_reducing_order(Exec(2), matrix);
    REQUIRE(order);
    CHECK(is_permutation(*order, matrix.size()));
  }
}

TEST_CASE("fill-reducing order: rows with very many entries come last") {
  shapes::Random random(53);
  auto edges = grid_edges(60, 60);
  for (Index v = 0; v < 1800; ++v) edges.insert({3600, 2 * v}), edges.insert({3601, v});
  const auto order = fill_reducing_order(Exec(1), sparse_cases::from_edges(3602, edges, random));
  REQUIRE(order);
  CHECK(is_permutation(*order, 3602));
  CHECK(std::set<Index>(order->end() - 2, order->end()) == std::set<Index>{3600, 3601});
}

TEST_CASE("fill-reducing order: 1, 2 and 7 threads give the same") {
  const SymmetricMatrix matrix = grid(200, 150);
  const auto one = fill_reducing_order(Exec(1), matrix);
  CHECK(*fill_reducing_order(Exec(2), matrix) == *one);
  CHECK(*fill_reducing_order(Exec(7), matrix) == *one);
}

TEST_CASE("fill-reducing order: on a grid the factor has at most a tenth more entries than with METIS") {
  const SymmetricMatrix matrix = grid(180, 130);
  const auto own = count_factor(matrix, *fill_reducing_order(Exec(2), matrix));
  const auto metis = count_factor(matrix, CholmodReference::metis(matrix));
  CHECK(static_cast<double>(*own) < 1.1 * static_cast<double>(*metis));
}

TEST_CASE("separator: no edge joins the sides, weights add up, a grid is cut along its short side") {
  const Index width = 120, height = 40;
  const auto edges = grid_edges(width, height);
  const Separator s = find_separator(graph_of(width * height, edges));
  for (const auto& [a, b] : edges)
    CHECK((s.side[a] == s.side[b] || s.side[a] == kSeparator || s.side[b] == kSeparator));
  std::array<Offset, 3> weight{};
  for (const std::uint8_t side : s.side) ++weight[side];
  CHECK(weight == s.weight);
  CHECK(s.weight[2] <= height + 5);
  CHECK(std::max(s.weight[0], s.weight[1]) <= 0.6 * width * height + 1);
}

TEST_CASE("separator: two grids side by side need none") {
  auto edges = grid_edges(30, 30);
  edges.merge(grid_edges(30, 30, 900));
  const Separator s = find_separator(graph_of(1800, edges));
  CHECK(s.weight[2] == 0);
  CHECK(s.weight[0] == 900);
}

TEST_CASE("coarsening: groups are connected, weights and edges add up") {
  for (const Index width : {40, 100}) {  // along edges, and whole neighbourhoods
    const Graph fine = graph_of(width * 50, grid_edges(width, 50));
    for (const std::uint64_t seed : {0, 3}) {
      std::vector<Index> group;
      const Graph coarse = coarsen(fine, seed, group);
      CHECK(coarse.size() < fine.size() / 2);
      Offset weight = 0, crossing = 0, edges = 0;
      for (const Index w : coarse.weight) weight += w;
      for (const Index w : coarse.edge_weight) edges += w;
      for (Index v = 0; v < fine.size(); ++v) {
        for (const Index u : fine.neighbours(v)) crossing += group[u] != group[v];
      }
      CHECK(weight == fine.size());
      CHECK(edges == crossing);
      for (Index g = 0; g < coarse.size(); ++g) {
        for (const Index other : coarse.neighbours(g)) CHECK(other != g);
      }
    }
  }
}

TEST_CASE(
    "graph levels: a part keeps its groups, weights add up, and no edge is missing in a coarser graph") {
  GraphLevels whole;
  whole.graph.push_back(graph_of(200 * 150, grid_edges(200, 150)));
  const Separator s = find_separator(whole);
  CHECK(whole.graph.size() > 1);
  for (std::uint8_t which = 0; which < 2; ++which) {
    std::vector<Index> vertex;
    const GraphLevels part = part_of(whole, s.side, which, vertex);
    REQUIRE(part.graph.size() > 1);
    CHECK(part.graph[0].size() == s.weight[which]);
    for (std::size_t l = 0; l + 1 < part.graph.size(); ++l) {
      const Graph &fine = part.graph[l], &coarse = part.graph[l + 1];
      CHECK(std::accumulate(coarse.weight.begin(), coarse.weight.end(), Offset{0}) == s.weight[which]);
      for (Index v = 0; v < fine.size(); ++v) {
        const Index g = part.group[l][v];
        for (const Index u : fine.neighbours(v)) {
          const In<Index> around = coarse.neighbours(g);
          CHECK((part.group[l][u] == g ||
                 std::find(around.begin(), around.end(), part.group[l][u]) != around.end()));
        }
      }
    }
    for (std::size_t v = 0; v < vertex.size(); ++v)
      CHECK((v == 0 || whole.group[0][vertex[v]] != whole.group[0][vertex[v - 1]] ||
             part.group[0][v] == part.group[0][v - 1]));
  }
}
