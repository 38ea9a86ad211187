#include "engine/prepare/component_cut.hpp"

#include "engine/prepare/arc_shortening.hpp"
#include "engine/prepare/cut_edges.hpp"

namespace planish {
namespace {

/// Roots tried in a component: more where each is cheap.
constexpr Index kMaxRoots = 8, kTrianglesOfAllRoots = 1 << 18;

class ComponentCut {
 public:
  ComponentCut(const Surface& surface, const Topology& topology, const CutComponent& component,
               CutColumns& columns)
      : surface_(surface),
        component_(component),
        m_(columns),
        graph_(surface, topology, columns.hole),
        edges_(graph_, columns) {
    for (Index t : component.triangle) {
      for (Index c = 3 * t; c < 3 * t + 3; ++c) hole_cost_ += m_.cost[c];
    }
  }

  std::vector<Index> run() {
    std::vector<Index> edges = component_.genus == 0 ? long_path() : best_graph();
    for (Index& c : edges) c = std::min(c, graph_.twin(c));
    return edges;
  }

 private:
  Index start_node(Index c) const { return graph_.node(graph_.start(c)); }
  Index end_node(Index c) const { return graph_.node(graph_.end(c)); }

  /// Shortest paths from a root to all nodes of the component; entering a hole costs more than any way around.
  /// Edge `closed` (kNone: no edge) is not used.
  void grow_tree(Index root, In<double> cost, Index closed = kNone) {
    for (Index v : component_.vertex) m_.distance[v] = kInfinity;
    m_.distance[root] = 0, m_.arrival[root] = kNone;
    open_.push(0, root);
    while (!open_.empty()) {
      const auto [distance, u] = open_.pop();
      if (distance > m_.distance[u]) continue;
      graph_.for_each_spoke(u, [&](Index c) {
        const Index v = end_node(c);
        const double next = distance + cost[c] + (graph_.is_hole(v) ? hole_cost_ : 0);
        if (next >= m_.distance[v] || c == closed || graph_.twin(c) == closed) return;
        m_.distance[v] = next, m_.arrival[v] = c;
        open_.push(next, v);
      });
    }
  }

  /// The vertex of largest value, holes left out (kNone where there are only holes).
  template <class Value>
  Index farthest(Value&& value) const {
    Index best = kNone;
    for (Index v : component_.vertex) {
      if (!graph_.is_hole(v) && (best == kNone || value(v) > value(best))) best = v;
    }
    return best;
  }

  Index farthest_from_centre() const {
    Vec3 centre;
    for (Index v : component_.vertex) centre = centre + surface_.position[v];
    centre = 1.0 / static_cast<double>(component_.vertex.size()) * centre;
    return farthest([&](Index v) { return norm(surface_.position[v] - centre); });
  }

  /// A cheapest path between two points far apart by length; never one edge alone, which opens nothing.
  std::vector<Index> long_path() {
    const auto distance = [&](Index v) { return m_.distance[v]; };
    grow_tree(farthest_from_centre(), m_.length);
    const Index from = farthest(distance);
    grow_tree(from, m_.length);
    const Index to = farthest(distance);
    grow_tree(from, m_.cost);
    if (graph_.start(m_.arrival[to]) == from) grow_tree(from, m_.cost, m_.arrival[to]);
    std::vector<Index> path;
    for (Index v = to; v != from; v = graph_.start(path.back())) path.push_back(m_.arrival[v]);
    return path;
  }

  Index set(Index t) {
    while (m_.parent[t] != t) t = m_.parent[t] = m_.parent[m_.parent[t]];
    return t;
  }

  bool unite(Index a, Index b) {
    a = set(a), b = set(b);
    m_.parent[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

  /// The 2 g edges in neither the tree nor the cotree that crosses the edges of the longest loops.
  std::vector<Index> closing_edges() {
    loops_.clear();
    for (Index t : component_.triangle) {
      m_.parent[t] = t;
      for (Index c = 3 * t; c < 3 * t + 3; ++c) {
        if (graph_.twin(c) < c) continue;
        const Index a = start_node(c), b = end_node(c);
        if (m_.arrival[b] == c || m_.arrival[a] == graph_.twin(c)) continue;
        loops_.emplace_back(-(m_.distance[a] + m_.cost[c] + m_.distance[b]), c);
      }
    }
    std::sort(loops_.begin(), loops_.end());
    std::vector<Index> closing;
    for (const auto& [length, c] : loops_) {
      if (!unite(c / 3, graph_.twin(c) / 3)) closing.push_back(c);
    }
    return closing;
  }

  /// Cuts along the tree's loops through the given edges.
  void cut_loops(In<Index> closing) {
    for (Index e : closing) {
      edges_.add(e);
      for (Index v : {start_node(e), end_node(e)}) {
        while (m_.arrival[v] != kNone && !edges_.is_cut(m_.arrival[v])) {
          edges_.add(m_.arrival[v]);
          v = start_node(m_.arrival[v]);
        }
      }
    }
  }

  /// Of the graph's edges, and of the holes it goes through.
  double total_cost() const {
    double sum = 0;
    for (Index c : edges_.list()) {
      sum += m_.cost[c];
      for (Index v : {start_node(c), end_node(c)}) {
        sum += graph_.is_hole(v) ? hole_cost_ / m_.degree[v] : 0;
      }
    }
    return sum;
  }

  /// Shortened graphs from roots spread over the component; the cheapest.
  std::vector<Index> best_graph() {
    const auto num_triangles = static_cast<Index>(component_.triangle.size());
    const Index num_roots = std::clamp<Index>(kTrianglesOfAllRoots / num_triangles, 1, kMaxRoots);
    for (Index v : component_.vertex) m_.nearest_root[v] = kInfinity;
    std::vector<Index> best;
    double best_cost = kInfinity;
    Index root = farthest_from_centre();
    if (root == kNone) root = graph_.node(component_.vertex[0]);
    for (Index k = 0; k < num_roots && root != kNone; ++k) {
      grow_tree(root, m_.cost);
      for (Index v : component_.vertex) m_.nearest_root[v] = std::min(m_.nearest_root[v], m_.distance[v]);
      cut_loops(closing_edges());
      edges_.prune();
      shorten_arcs(graph_, component_, m_, edges_);
      if (const double cost = total_cost(); cost < best_cost) best_cost = cost, best = edges_.list();
      edges_.clear();
      root = farthest([&](Index v) { return m_.nearest_root[v]; });
    }
    return best;
  }

  const Surface& surface_;
  const CutComponent& component_;
  CutColumns& m_;
  HoleGraph graph_;
  CutEdges edges_;
  double hole_cost_ = 0;  ///< more than any path without holes
  NodeQueue open_;
  std::vector<std::pair<double, Index>> loops_;  ///< minus the length, and the edge that closes the loop
};

}  // namespace

std::vector<Index> cut_component(const Surface& surface, const Topology& topology,
                                 const CutComponent& component, CutColumns& columns) {
  return ComponentCut(surface, topology, component, columns).run();
}

}  // namespace planish
