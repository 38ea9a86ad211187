#include "engine/solve/fill_reducing_order.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>

#include "engine/solve/separator.hpp"
#include "kernels/sparse/minimum_degree.hpp"

namespace planish {
namespace {

constexpr Index kLeaf = 250;         // vertices that minimum degree orders
constexpr Index kTaskSize = 5000;    // vertices whose two parts are tasks
constexpr double kDenseDegree = 10;  // times the root of n: eliminated last

/// Graph of the matrix without its dense rows.
Graph sparse_graph(const SymmetricMatrix& matrix, In<std::uint8_t> dense) {
  const Index n = matrix.size();
  Graph graph;
  std::vector<Index> count(n, 0);
  const auto visit = [&](auto&& edge) {
    for (Index j = 0; j < n; ++j) {
      for (Index k = matrix.column_begin[j] + 1; k < matrix.column_begin[j + 1]; ++k) {
        if (!dense[j] && !dense[matrix.row[k]]) edge(j, matrix.row[k]);
      }
    }
  };
  visit([&](Index a, Index b) { ++count[a], ++count[b]; });
  graph.begin = exclusive_scan(count);
  graph.neighbour.resize(graph.begin[n]);
  graph.weight.assign(n, 1);
  std::copy_n(graph.begin.begin(), n, count.begin());
  visit([&](Index a, Index b) { graph.neighbour[count[a]++] = b, graph.neighbour[count[b]++] = a; });
  return graph;
}

std::vector<std::uint8_t> dense_rows(const SymmetricMatrix& matrix) {
  const Index n = matrix.size();
  std::vector<Index> degree(n, 0);
  for (Index j = 0; j < n; ++j) {
    for (Index k = matrix.column_begin[j] + 1; k < matrix.column_begin[j + 1]; ++k)
      ++degree[j], ++degree[matrix.row[k]];
  }
  const double most = std::max(16.0, kDenseDegree * std::sqrt(n));
  std::vector<std::uint8_t> dense(n);
  for (Index v = 0; v < n; ++v) dense[v] = degree[v] > most;
  return dense;
}

class Dissection {
 public:
  Dissection(const Exec& exec, const Graph& whole, Out<Index> order)
      : exec_(exec), whole_(whole), order_(order) {}

  /// Orders a part of the whole: its vertices take the places [begin, begin + size).
  void run(GraphLevels levels, std::vector<Index> vertex, Index begin) const {
    const Index size = levels.graph[0].size();
    if (size <= kLeaf) return order_leaf(vertex, begin);
    const bool tasks = size > kTaskSize;
    Separator s = find_separator(levels);
    std::array<GraphLevels, 2> side;
    std::array<std::vector<Index>, 2> inside;
    const auto take = [&](std::uint8_t k) {
      side[k] = part_of(levels, s.side, k, inside[k]);
      for (Index& v : inside[k]) v = vertex[v];
    };
    const auto take_first = [&] { take(0); };
    const auto take_second = [&] { take(1); };
    in_parts(tasks, take_first, take_second);
    const Index split = begin + side[0].graph[0].size(), last = split + side[1].graph[0].size();
    Index at = last;
    for (Index v = 0; v < size; ++v) {
      if (s.side[v] == kSeparator) order_[at++] = vertex[v];
    }
    if (last == begin) return;  // nothing is separated, as in a complete graph
    levels = {}, vertex = {}, s = {};
    const auto first = [&] { run(std::move(side[0]), std::move(inside[0]), begin); };
    const auto second = [&] { run(std::move(side[1]), std::move(inside[1]), split); };
    in_parts(tasks, first, second);
  }

 private:
  template <class First, class Second>
  void in_parts(bool tasks, First first, Second second) const {
    if (tasks) return exec_.both(first, second);
    first();
    second();
  }

  /// Neighbours outside the leaf are in separators, which come later.
  void order_leaf(const std::vector<Index>& vertex, Index begin) const {
    const auto inner = static_cast<Index>(vertex.size());
    std::vector<Index> around = neighbours_outside(vertex);
    if (inner + static_cast<Index>(around.size()) > kSmallGraph) around.clear();
    std::vector<VertexSet> adjacent(inner + around.size(), VertexSet{});
    const auto place = [&](Index v) -> Index {
      const auto at = std::lower_bound(vertex.begin(), vertex.end(), v);
      if (at != vertex.end() && *at == v) return static_cast<Index>(at - vertex.begin());
      const auto outside = std::lower_bound(around.begin(), around.end(), v);
      return outside == around.end() ? kNone : inner + static_cast<Index>(outside - around.begin());
    };
    const auto insert = [&](Index a, Index b) { adjacent[a][b / 64] |= std::uint64_t{1} << (b % 64); };
    for (Index a = 0; a < inner; ++a) {
      for (const Index u : whole_.neighbours(vertex[a])) {
        const Index b = place(u);
        if (b != kNone) insert(a, b), insert(b, a);
      }
    }
    std::vector<Index> local(inner);
    minimum_degree(inner, adjacent, local);
    for (Index k = 0; k < inner; ++k) order_[begin + k] = vertex[local[k]];
  }

  std::vector<Index> neighbours_outside(const std::vector<Index>& vertex) const {
    std::vector<Index> around;
    for (const Index v : vertex) {
      for (const Index u : whole_.neighbours(v)) {
        if (!std::binary_search(vertex.begin(), vertex.end(), u)) around.push_back(u);
      }
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    return around;
  }

  const Exec& exec_;
  const Graph& whole_;
  Out<Index> order_;
};

}  // namespace

Result<std::vector<Index>> fill_reducing_order(const Exec& exec, const SymmetricMatrix& matrix) try {
  const Index n = matrix.size();
  const std::vector<std::uint8_t> dense = dense_rows(matrix);
  const Graph whole = sparse_graph(matrix, dense);
  std::vector<Index> order(n), vertex(n), local;
  std::iota(vertex.begin(), vertex.end(), 0);
  Graph start = whole;
  if (std::find(dense.begin(), dense.end(), 1) != dense.end()) {
    local.resize(n);
    start = part_of(whole, dense, 0, local, vertex);
  }
  auto at = static_cast<Index>(vertex.size());
  for (Index v = 0; v < n; ++v) {
    if (dense[v]) order[at++] = v;
  }
  GraphLevels levels;
  levels.graph.push_back(std::move(start));
  Dissection(exec, whole, order).run(std::move(levels), std::move(vertex), 0);
  return order;
} catch (const std::bad_alloc&) {
  return fail(ErrorCode::OutOfMemory, "not enough memory for the ordering of the sparse factor");
}

}  // namespace planish
