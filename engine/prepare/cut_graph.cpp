#include "engine/prepare/cut_graph.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace planish {
namespace {

/// Roots tried in a component: more where each is cheap.
constexpr Index kMaxRoots = 8, kTrianglesOfAllRoots = 1 << 18;
/// Replacing arcs ends after so many rounds, or so many steps a triangle; few meshes need three rounds.
constexpr int kMaxRounds = 16;
constexpr Offset kStepsPerTriangle = 400;
/// A replacement must be shorter by more than rounding, or two equal arcs would take turns.
constexpr double kShorter = 1 - 1e-9;

/// Items of each group in ascending order, as compressed rows.
struct Groups {
  std::vector<Index> begin, item;
  In<Index> group(Index g) const { return slice(In<Index>(item), Offsets{begin}.group(g)); }
};

/// group_of(i) in [0, num_groups), or kNone for none.
template <class GroupOf>
Groups group_items(Index num_items, Index num_groups, GroupOf&& group_of) {
  std::vector<Index> counts(num_groups, 0);
  for (Index i = 0; i < num_items; ++i) {
    if (const Index g = group_of(i); g != kNone) ++counts[g];
  }
  Groups groups{exclusive_scan(counts), {}};
  groups.item.resize(groups.begin.back());
  std::vector<Index> place(groups.begin.begin(), groups.begin.end() - 1);
  for (Index i = 0; i < num_items; ++i) {
    if (const Index g = group_of(i); g != kNone) groups.item[place[g]++] = i;
  }
  return groups;
}

struct Component {
  In<Index> triangle, vertex;
  Index loops = 0, genus = 0;
  bool needs_cut() const { return genus > 0 || loops == 0; }
};

/// Columns of the whole mesh; each component reads and writes its own part.
struct Columns {
  std::vector<double> length, cost;  ///< [3 T] of half-edges, mesh units
  std::vector<Index> hole;           ///< [V] boundary loop or kNone
  std::vector<double> distance;      ///< [V] from the root, or across the opened surface
  std::vector<double> nearest_root;  ///< [V] distance from the nearest root so far
  std::vector<Index> arrival;        ///< [V] half-edge by which the shortest path comes in, kNone at a root
  std::vector<Index> degree;         ///< [V] cut half-edges that leave the node
  std::vector<Index> parent;         ///< [T] of the disjoint sets of triangles
  std::vector<std::uint8_t> cut;     ///< [3 T] 1: cut, 2: cut and on an arc already traced
  std::vector<std::uint8_t> side;    ///< [3 T] side of the annulus that the corner lies on, 0: neither
};

/// Cuts one component. Nodes are vertices; a boundary loop is one node, known by its first vertex.
class Cutter {
 public:
  Cutter(const Surface& surface, const Topology& topology, const Component& component, Columns& columns)
      : surface_(surface), topology_(topology), component_(component), m_(columns) {
    for (Index t : component.triangle) {
      for (Index c = 3 * t; c < 3 * t + 3; ++c) hole_cost_ += m_.cost[c];
    }
  }

  std::vector<Index> run() {
    std::vector<Index> edges = component_.genus == 0 ? long_path() : best_graph();
    for (Index& c : edges) c = std::min(c, topology_.corner_twin[c]);
    return edges;
  }

 private:
  using Step = std::pair<double, Index>;  // distance of a node; cost of an edge
  struct Arc {
    double cost = 0;
    std::vector<Index> corner;
  };

  Index start(Index c) const { return surface_.corner_vertex[c]; }
  Index end(Index c) const { return surface_.corner_vertex[next_corner(c)]; }
  Index twin(Index c) const { return topology_.corner_twin[c]; }
  bool is_hole(Index node) const { return m_.hole[node] != kNone; }
  Index node(Index v) const {
    return is_hole(v) ? start(topology_.loop_corner[topology_.loop_begin[m_.hole[v]]]) : v;
  }

  /// body(half-edge) for the interior half-edges that leave a node.
  template <class Body>
  void for_each_spoke(Index node, Body&& body) const {
    const auto around = [&](Index v) {
      for (Index k = topology_.star_begin[v]; k < topology_.star_begin[v + 1]; ++k) {
        if (const Index c = topology_.star_corner[k]; twin(c) != kNone) body(c);
      }
    };
    if (!is_hole(node)) return around(node);
    const Range loop = topology_.loops().group(m_.hole[node]);
    for (Index k = loop.begin; k < loop.end; ++k) around(start(topology_.loop_corner[k]));
  }

  void push(double distance, Index node) {
    heap_.emplace_back(distance, node);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  }

  Step pop() {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    const Step step = heap_.back();
    heap_.pop_back();
    return step;
  }

  /// Shortest paths from a root to all nodes of the component; entering a hole costs more than any way around.
  /// Edge `closed` (kNone: no edge) is not used.
  void grow_tree(Index root, In<double> cost, Index closed = kNone) {
    for (Index v : component_.vertex) m_.distance[v] = kInfinity;
    m_.distance[root] = 0, m_.arrival[root] = kNone;
    push(0, root);
    while (!heap_.empty()) {
      const auto [distance, u] = pop();
      if (distance > m_.distance[u]) continue;
      for_each_spoke(u, [&](Index c) {
        const Index v = node(end(c));
        const double next = distance + cost[c] + (is_hole(v) ? hole_cost_ : 0);
        if (next >= m_.distance[v] || c == closed || twin(c) == closed) return;
        m_.distance[v] = next, m_.arrival[v] = c;
        push(next, v);
      });
    }
  }

  /// The vertex of largest value, holes left out (kNone where there are only holes).
  template <class Value>
  Index farthest(Value&& value) const {
    Index best = kNone;
    for (Index v : component_.vertex) {
      if (!is_hole(v) && (best == kNone || value(v) > value(best))) best = v;
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
    if (start(m_.arrival[to]) == from) grow_tree(from, m_.cost, m_.arrival[to]);
    std::vector<Index> path;
    for (Index v = to; v != from; v = start(path.back())) path.push_back(m_.arrival[v]);
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
        if (twin(c) < c) continue;
        const Index a = node(start(c)), b = node(end(c));
        if (m_.arrival[b] == c || m_.arrival[a] == twin(c)) continue;
        loops_.emplace_back(-(m_.distance[a] + m_.cost[c] + m_.distance[b]), c);
      }
    }
    std::sort(loops_.begin(), loops_.end());
    std::vector<Index> closing;
    for (const auto& [length, c] : loops_) {
      if (!unite(c / 3, twin(c) / 3)) closing.push_back(c);
    }
    return closing;
  }

  void set_cut(Index c, bool cut) {
    m_.cut[c] = m_.cut[twin(c)] = cut;
    const Index by = cut ? 1 : -1;
    m_.degree[node(start(c))] += by, m_.degree[node(end(c))] += by;
  }

  void add_edge(Index c) {
    set_cut(c, true);
    edges_.push_back(c);
  }

  void drop_uncut() {
    std::erase_if(edges_, [&](Index c) { return !m_.cut[c]; });
  }

  /// Cuts along the tree's loops through the given edges.
  void cut_loops(In<Index> closing) {
    for (Index e : closing) {
      add_edge(e);
      for (Index v : {node(start(e)), node(end(e))}) {
        while (m_.arrival[v] != kNone && !m_.cut[m_.arrival[v]]) {
          add_edge(m_.arrival[v]);
          v = node(start(m_.arrival[v]));
        }
      }
    }
  }

  /// Removes dangling branches: edges at nodes with no other.
  void prune() {
    std::vector<Index> tips;
    for (Index c : edges_) {
      for (Index v : {node(start(c)), node(end(c))}) {
        if (m_.degree[v] == 1) tips.push_back(v);
      }
    }
    while (!tips.empty()) {
      const Index tip = tips.back();
      tips.pop_back();
      if (m_.degree[tip] != 1) continue;
      const Index c = cut_spoke(tip, 1);
      set_cut(c, false);
      if (const Index v = node(end(c)); m_.degree[v] == 1) tips.push_back(v);
    }
    drop_uncut();
  }

  /// A half-edge with this mark that leaves the node, or kNone.
  Index cut_spoke(Index node, std::uint8_t mark) const {
    Index found = kNone;
    for_each_spoke(node, [&](Index c) {
      if (m_.cut[c] == mark) found = c;
    });
    return found;
  }

  bool ends_arcs(Index node) const { return m_.degree[node] != 2 || is_hole(node); }

  /// The graph's arcs between branching nodes and holes, the costliest first.
  std::vector<Arc> arcs() {
    std::vector<Arc> arcs;
    for (Index e : edges_) {
      for (Index c : {e, twin(e)}) {
        if (m_.cut[c] != 1 || !ends_arcs(node(start(c)))) continue;
        Arc arc;
        for (Index next = c; next != kNone;) {
          arc.corner.push_back(next);
          arc.cost += m_.cost[next];
          m_.cut[next] = m_.cut[twin(next)] = 2;
          const Index v = node(end(next));
          next = ends_arcs(v) ? kNone : cut_spoke(v, 1);
        }
        arcs.push_back(std::move(arc));
      }
    }
    for (Index c : edges_) m_.cut[c] = m_.cut[twin(c)] = 1;
    std::stable_sort(arcs.begin(), arcs.end(), [](const Arc& a, const Arc& b) { return a.cost > b.cost; });
    return arcs;
  }

  /// Whether an arc is still one after others were replaced.
  bool is_intact(const Arc& arc) const {
    for (std::size_t k = 0; k < arc.corner.size(); ++k) {
      if (!m_.cut[arc.corner[k]]) return false;
      if (k > 0 && ends_arcs(node(start(arc.corner[k])))) return false;
    }
    return true;
  }

  bool is_wall(Index c) const { return twin(c) == kNone || m_.cut[c]; }

  /// Walks along the border of the opened surface from one wall until it closes, and labels its corners.
  void label_border(Index first, std::uint8_t side) {
    Index c = first;
    do {
      for (c = next_corner(c);; c = next_corner(twin(c))) {  // clockwise around the wall's end
        m_.side[c] = side;
        border_.push_back(c);
        ++steps_;
        if (is_wall(c)) break;
      }
    } while (c != first);
  }

  /// Without one arc the opened surface is an annulus (with holes): labels its two borders 1 and 2.
  void label_borders() {
    std::uint8_t sides = 0;
    for (Index e : edges_) {
      if (!m_.cut[e]) continue;
      for (Index c : {e, twin(e)}) {
        if (m_.side[c] == 0) label_border(c, ++sides);
      }
    }
  }

  /// Shortest path from border 1 to border 2 that is shorter than `bound`, meeting no border and no hole in
  /// between; empty where there is none. Its half-edges, last first.
  std::vector<Index> shortest_crossing(double bound) {
    Index last = kNone;
    const auto relax = [&](double distance, Index c) {
      const double next = distance + m_.cost[c];
      const std::uint8_t side = m_.side[next_corner(c)];
      if (next >= bound || side == 1) return;
      if (side == 2) {
        bound = next, last = c;
        return;
      }
      const Index v = end(c);
      if (is_hole(v) || next >= m_.distance[v]) return;
      if (m_.distance[v] == kInfinity) reached_.push_back(v);
      m_.distance[v] = next, m_.arrival[v] = c;
      push(next, v);
    };
    for (Index c : border_) {
      if (m_.side[c] == 1 && !is_wall(c)) relax(0, c);
    }
    while (!heap_.empty()) {
      const auto [distance, v] = pop();
      if (distance > m_.distance[v] || distance >= bound) continue;
      for_each_spoke(v, [&](Index c) { relax(distance, c); });
      ++steps_;
    }
    std::vector<Index> path;
    for (Index c = last; c != kNone; c = m_.side[c] == 1 ? kNone : m_.arrival[start(c)]) path.push_back(c);
    return path;
  }

  void forget_search() {
    for (Index v : reached_) m_.distance[v] = kInfinity;
    for (Index c : border_) m_.side[c] = 0;
    reached_.clear(), border_.clear();
  }

  /// Puts the shortest path across the annulus in the place of an arc. False: the arc is one already.
  bool replace(const Arc& arc) {
    for (Index c : arc.corner) set_cut(c, false);
    label_borders();
    const std::vector<Index> path = shortest_crossing(arc.cost * kShorter);
    forget_search();
    if (path.empty()) {
      for (Index c : arc.corner) set_cut(c, true);
      return false;
    }
    drop_uncut();
    for (Index c : path) add_edge(c);
    prune();
    return true;
  }

  void shorten() {
    for (Index v : component_.vertex) m_.distance[v] = kInfinity;
    const Offset limit = kStepsPerTriangle * static_cast<Offset>(component_.triangle.size());
    steps_ = 0;
    bool changed = true;
    for (int round = 0; changed && round < kMaxRounds; ++round) {
      changed = false;
      for (const Arc& arc : arcs()) {
        if (steps_ < limit && is_intact(arc) && replace(arc)) changed = true;
      }
    }
  }

  /// Of the graph's edges, and of the holes it goes through.
  double total_cost() const {
    double sum = 0;
    for (Index c : edges_) {
      sum += m_.cost[c];
      for (Index v : {node(start(c)), node(end(c))}) sum += is_hole(v) ? hole_cost_ / m_.degree[v] : 0;
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
    if (root == kNone) root = node(component_.vertex[0]);
    for (Index k = 0; k < num_roots && root != kNone; ++k) {
      grow_tree(root, m_.cost);
      for (Index v : component_.vertex) m_.nearest_root[v] = std::min(m_.nearest_root[v], m_.distance[v]);
      cut_loops(closing_edges());
      prune();
      shorten();
      if (const double cost = total_cost(); cost < best_cost) best_cost = cost, best = edges_;
      for (Index c : edges_) set_cut(c, false);
      edges_.clear();
      root = farthest([&](Index v) { return m_.nearest_root[v]; });
    }
    return best;
  }

  const Surface& surface_;
  const Topology& topology_;
  const Component& component_;
  Columns& m_;
  double hole_cost_ = 0;  ///< more than any path without holes
  Offset steps_ = 0;
  std::vector<Step> heap_, loops_;
  std::vector<Index> edges_;             ///< of the graph, a half-edge each
  std::vector<Index> border_, reached_;  ///< corners labelled, nodes reached by the search under way
};

/// The sharp edges by the angle between the triangles' normals; triangles without area are not bent.
void price_edges(const Exec& exec, const Surface& surface, const Topology& topology,
                 In<Index> preferred_corner, const CutGraphOptions& options, Columns& columns) {
  const Index num_triangles = surface.num_triangles();
  const auto& twin = topology.corner_twin;
  const auto point = [&](Index c) { return surface.position[surface.corner_vertex[c]]; };
  std::vector<Vec3> normal(num_triangles);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      normal[t] = cross(point(3 * t + 1) - point(3 * t), point(3 * t + 2) - point(3 * t));
    }
  });
  columns.length.resize(3 * static_cast<std::size_t>(num_triangles));
  columns.cost.resize(columns.length.size());
  const double cosine = std::cos(options.sharp_degrees * kPi / 180);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    for (Index c = 3 * r.begin; c < 3 * r.end; ++c) {
      columns.cost[c] = columns.length[c] = norm(point(next_corner(c)) - point(c));
      if (twin[c] == kNone) continue;
      const Vec3 a = normal[c / 3], b = normal[twin[c] / 3];
      if (dot(a, b) < cosine * norm(a) * norm(b)) columns.cost[c] *= options.sharp_discount;
    }
  });
  for (Index p : preferred_corner) {
    for (Index c : {p, twin[p]}) {
      if (c != kNone) columns.cost[c] = columns.length[c] * options.sharp_discount;
    }
  }
}

Columns make_columns(const Exec& exec, const Surface& surface, const Topology& topology,
                     In<Index> preferred_corner, const CutGraphOptions& options) {
  Columns columns;
  price_edges(exec, surface, topology, preferred_corner, options, columns);
  const std::size_t num_vertices = surface.position.size(), num_corners = surface.corner_vertex.size();
  columns.hole.assign(num_vertices, kNone);
  for (Index l = 0; l < topology.num_loops(); ++l) {
    for (Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(l))) {
      columns.hole[surface.corner_vertex[c]] = l;
    }
  }
  columns.distance.resize(num_vertices);
  columns.nearest_root.resize(num_vertices);
  columns.arrival.resize(num_vertices);
  columns.degree.assign(num_vertices, 0);
  columns.parent.resize(num_corners / 3);
  columns.cut.assign(num_corners, 0);
  columns.side.assign(num_corners, 0);
  return columns;
}

/// Loops and genus of each component, with its triangles and vertices.
std::vector<Component> find_components(const Topology& topology, const Groups& triangles,
                                       const Groups& vertices) {
  std::vector<Component> components(topology.num_components);
  std::vector<Index> border(components.size(), 0);
  for (Index l = 0; l < topology.num_loops(); ++l) {
    const Range loop = topology.loops().group(l);
    const Index k = topology.triangle_component[topology.loop_corner[loop.begin] / 3];
    ++components[k].loops;
    border[k] += loop.end - loop.begin;
  }
  for (std::size_t k = 0; k < components.size(); ++k) {
    Component& component = components[k];
    component.triangle = triangles.group(static_cast<Index>(k));
    component.vertex = vertices.group(static_cast<Index>(k));
    const auto faces = static_cast<Offset>(component.triangle.size());
    const Offset euler = static_cast<Offset>(component.vertex.size()) - (3 * faces + border[k]) / 2 + faces;
    component.genus = static_cast<Index>((2 - component.loops - euler) / 2);
  }
  return components;
}

}  // namespace

CutGraph find_cut_graph(const Exec& exec, const Surface& surface, const Topology& topology,
                        In<Index> preferred_corner, const CutGraphOptions& options) {
  const auto& component_of = topology.triangle_component;
  const Groups triangles =
      group_items(surface.num_triangles(), topology.num_components, [&](Index t) { return component_of[t]; });
  const Groups vertices = group_items(surface.num_vertices(), topology.num_components, [&](Index v) {
    const Range star = topology.stars().group(v);
    return star.begin == star.end ? kNone : component_of[topology.star_corner[star.begin] / 3];
  });
  std::vector<Component> components = find_components(topology, triangles, vertices);
  std::erase_if(components, [](const Component& component) { return !component.needs_cut(); });
  CutGraph graph;
  if (components.empty()) return graph;

  Columns columns = make_columns(exec, surface, topology, preferred_corner, options);
  std::vector<std::vector<Index>> edges(components.size());
  exec.for_tasks(static_cast<Index>(components.size()),
                 [&](Index k) { edges[k] = Cutter(surface, topology, components[k], columns).run(); });
  for (const auto& part : edges) graph.corner.insert(graph.corner.end(), part.begin(), part.end());
  std::sort(graph.corner.begin(), graph.corner.end());
  std::vector<double> length;
  for (Index c : graph.corner) length.push_back(columns.length[c]);
  graph.length = pairwise_sum(length);
  return graph;
}

}  // namespace planish
