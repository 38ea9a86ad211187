#include "engine/prepare/arc_shortening.hpp"

namespace planish {
namespace {

/// Replacing arcs ends after so many rounds, or so many steps a triangle; few meshes need three rounds.
constexpr int kMaxRounds = 16;
constexpr Offset kStepsPerTriangle = 400;
/// A replacement must be shorter by more than rounding, or two equal arcs would take turns.
constexpr double kShorter = 1 - 1e-9;

class ArcShortening {
 public:
  ArcShortening(const HoleGraph& graph, CutColumns& columns, CutEdges& edges)
      : graph_(graph), m_(columns), edges_(edges) {}

  void run(const CutComponent& component) {
    for (Index v : component.vertex) m_.distance[v] = kInfinity;
    const Offset limit = kStepsPerTriangle * static_cast<Offset>(component.triangle.size());
    bool changed = true;
    for (int round = 0; changed && round < kMaxRounds; ++round) {
      changed = false;
      for (const CutEdges::Arc& arc : edges_.arcs()) {
        if (steps_ < limit && edges_.is_intact(arc) && replace(arc)) changed = true;
      }
    }
  }

 private:
  bool is_wall(Index c) const { return graph_.twin(c) == kNone || edges_.is_cut(c); }

  /// Walks along the border of the opened surface from one wall until it closes, and labels its corners.
  void label_border(Index first, std::uint8_t side) {
    Index c = first;
    do {
      for (c = next_corner(c);; c = next_corner(graph_.twin(c))) {  // clockwise around the wall's end
        m_.side[c] = side;
        border_.push_back(c);
        ++steps_;
        if (is_wall(c)) break;
      }
    } while (c != first);
  }

  /// Labels the two borders of the annulus 1 and 2.
  void label_borders() {
    std::uint8_t sides = 0;
    for (Index e : edges_.list()) {
      if (!edges_.is_cut(e)) continue;
      for (Index c : {e, graph_.twin(e)}) {
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
      const Index v = graph_.end(c);
      if (graph_.is_hole(v) || next >= m_.distance[v]) return;
      if (m_.distance[v] == kInfinity) reached_.push_back(v);
      m_.distance[v] = next, m_.arrival[v] = c;
      open_.push(next, v);
    };
    for (Index c : border_) {
      if (m_.side[c] == 1 && !is_wall(c)) relax(0, c);
    }
    while (!open_.empty()) {
      const auto [distance, v] = open_.pop();
      if (distance > m_.distance[v] || distance >= bound) continue;
      graph_.for_each_spoke(v, [&](Index c) { relax(distance, c); });
      ++steps_;
    }
    std::vector<Index> path;
    for (Index c = last; c != kNone; c = m_.side[c] == 1 ? kNone : m_.arrival[graph_.start(c)]) {
      path.push_back(c);
    }
    return path;
  }

  void forget_search() {
    for (Index v : reached_) m_.distance[v] = kInfinity;
    for (Index c : border_) m_.side[c] = 0;
    reached_.clear(), border_.clear();
  }

  /// Puts the shortest path across the annulus in the place of an arc. False: the arc is one already.
  bool replace(const CutEdges::Arc& arc) {
    for (Index c : arc.corner) edges_.set_cut(c, false);
    label_borders();
    const std::vector<Index> path = shortest_crossing(arc.cost * kShorter);
    forget_search();
    if (path.empty()) {
      for (Index c : arc.corner) edges_.set_cut(c, true);
      return false;
    }
    edges_.drop_uncut();
    for (Index c : path) edges_.add(c);
    edges_.prune();
    return true;
  }

  const HoleGraph& graph_;
  CutColumns& m_;
  CutEdges& edges_;
  Offset steps_ = 0;
  NodeQueue open_;
  std::vector<Index> border_, reached_;  ///< corners labelled, nodes reached by the search under way
};

}  // namespace

void shorten_arcs(const HoleGraph& graph, const CutComponent& component, CutColumns& columns,
                  CutEdges& edges) {
  ArcShortening(graph, columns, edges).run(component);
}

}  // namespace planish
