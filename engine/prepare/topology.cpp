#include "engine/prepare/topology.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "kernels/topology/stars.hpp"

namespace planish {
namespace {

/// Every task looks through all corners for those of its own vertices: a few of those passes take less time than sorting, and
/// more than a few tasks would only wait for memory.
void build_stars(const Exec& exec, const Surface& surface, Topology& topology) {
  const auto num_corners = static_cast<Index>(surface.corner_vertex.size());
  const Index num_vertices = surface.num_vertices(), num_tasks = std::min(exec.threads(), 8);
  const Index per_task = std::max<Index>(1, (num_vertices + num_tasks - 1) / num_tasks);
  const auto own = [&](Index task) {
    const auto bound = [&](Index k) { return std::min<Offset>(num_vertices, Offset{k} * per_task); };
    return Range{static_cast<Index>(bound(task)), static_cast<Index>(bound(task + 1))};
  };
  const auto visit_own = [&](Range vertices, auto visit) {
    for (Index c = 0; c < num_corners; ++c) {
      const Index v = surface.corner_vertex[c];
      if (v >= vertices.begin && v < vertices.end) visit(v, c);
    }
  };
  std::vector<Index>& begin = topology.star_begin;
  begin.assign(static_cast<std::size_t>(num_vertices) + 1, 0);
  exec.for_tasks(num_tasks,
                 [&](Index task) { visit_own(own(task), [&](Index v, Index) { ++begin[v + 1]; }); });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  topology.star_corner.resize(num_corners);
  exec.for_tasks(num_tasks, [&](Index task) {
    const Range vertices = own(task);
    std::vector<Index> end(begin.begin() + vertices.begin, begin.begin() + vertices.end);
    visit_own(vertices, [&](Index v, Index c) { topology.star_corner[end[v - vertices.begin]++] = c; });
  });
}

/// Smallest element of each set under concurrent unions: links point to smaller elements, so the roots, and
/// with them the labels, are the same however the threads interleave.
class ConcurrentSets {
 public:
  explicit ConcurrentSets(Index n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  Index root(Index x) {
    while (true) {
      const Index p = load(x);
      if (p == x) return x;
      const Index grand = load(p);
      if (grand != p) std::atomic_ref(parent_[x]).store(grand, std::memory_order_relaxed);
      x = grand;
    }
  }

  void unite(Index a, Index b) {
    while (true) {
      a = root(a), b = root(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      Index expected = a;
      if (std::atomic_ref(parent_[a]).compare_exchange_strong(expected, b)) return;
    }
  }

 private:
  Index load(Index x) { return std::atomic_ref(parent_[x]).load(std::memory_order_relaxed); }
  std::vector<Index> parent_;
};

void label_components(const Exec& exec, Topology& topology) {
  const auto num_triangles = static_cast<Index>(topology.corner_twin.size() / 3);
  ConcurrentSets sets(num_triangles);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    for (Index c = 3 * r.begin; c < 3 * r.end; ++c) {
      const Index twin = topology.corner_twin[c];
      if (twin != kNone && twin < c) sets.unite(c / 3, twin / 3);
    }
  });
  topology.triangle_component.resize(num_triangles);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) topology.triangle_component[t] = sets.root(t);
  });
  // Roots become consecutive numbers; a root comes before its members.
  auto& label = topology.triangle_component;
  for (Index t = 0; t < num_triangles; ++t) {
    label[t] = label[t] == t ? topology.num_components++ : label[label[t]];
  }
}

struct Loop {
  double length = 0;
  std::vector<Index> corners;
};

std::vector<Loop> trace_loops(const Surface& surface, const Topology& topology) {
  std::vector<Loop> loops;
  std::vector<std::uint8_t> visited(topology.corner_twin.size(), 0);
  for (Index start = 0; start < static_cast<Index>(visited.size()); ++start) {
    if (topology.corner_twin[start] != kNone || visited[start]) continue;
    Loop loop;
    for (Index c = start; !visited[c];) {
      visited[c] = 1;
      loop.corners.push_back(c);
      const Index end = surface.corner_vertex[next_corner(c)];
      loop.length += norm(surface.position[end] - surface.position[surface.corner_vertex[c]]);
      c = topology.star_corner[topology.star_begin[end]];  // a fan starts with its boundary half-edge
    }
    loops.push_back(std::move(loop));
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const Loop& a, const Loop& b) { return a.length > b.length; });
  return loops;
}

void store_loops(const std::vector<Loop>& loops, Topology& topology) {
  topology.loop_begin.assign(1, 0);
  for (const Loop& loop : loops) {
    topology.loop_corner.insert(topology.loop_corner.end(), loop.corners.begin(), loop.corners.end());
    topology.loop_begin.push_back(static_cast<Index>(topology.loop_corner.size()));
    topology.loop_length.push_back(loop.length);
  }
}

}  // namespace

Topology build_topology(const Exec& exec, const Surface& surface) {
  Topology topology;
  build_stars(exec, surface, topology);
  const std::size_t num_corners = surface.corner_vertex.size();
  topology.corner_twin.resize(num_corners);
  topology.edge_kind.resize(num_corners);
  exec.for_blocks(surface.num_triangles(), kBlock, [&](Index, Range r) {
    find_twins({3 * r.begin, 3 * r.end}, surface.corner_vertex, topology.stars(), topology.star_corner,
               topology.corner_twin, topology.edge_kind);
  });
  label_components(exec, topology);

  // Fans are walked through consistently oriented edges only.
  std::vector<Index> fan_twin = topology.corner_twin;
  for (std::size_t c = 0; c < num_corners; ++c) {
    if (topology.edge_kind[c] != EdgeKind::Interior) fan_twin[c] = kNone;
  }
  topology.single_fan.resize(surface.position.size());
  std::vector<Index> scratch(num_corners);
  exec.for_blocks(surface.num_vertices(), kBlock, [&](Index, Range r) {
    rotate_stars(r, fan_twin, topology.stars(), topology.star_corner, scratch, topology.single_fan);
  });

  const auto is_plain = [](EdgeKind k) { return k == EdgeKind::Interior || k == EdgeKind::Boundary; };
  topology.manifold =
      std::all_of(topology.edge_kind.begin(), topology.edge_kind.end(), is_plain) &&
      std::all_of(topology.single_fan.begin(), topology.single_fan.end(), [](auto f) { return f; });
  if (topology.manifold) {
    store_loops(trace_loops(surface, topology), topology);
    topology.num_edges = static_cast<Index>((num_corners + topology.loop_corner.size()) / 2);
  }
  return topology;
}

}  // namespace planish
