#include "engine/methods/angle_constraints.hpp"

#include <algorithm>
#include <map>

namespace planish {
namespace {

/// The corner at `tail` whose half-edge runs to `head`, kNone where no triangle has it.
Index half_edge_of(const FilledSurface& filled, Index tail, Index head) {
  for (const Index c : slice(In<Index>(filled.topology.star_corner), filled.topology.stars().group(tail))) {
    if (filled.corner_vertex[next_corner(c)] == head) return c;
  }
  return kNone;
}

/// Number of corners in the star of v, counter-clockwise, before the edge to u; of the last edge of an open star all.
Index place_of_edge(const FilledSurface& filled, Index v, Index u) {
  const auto star = slice(In<Index>(filled.topology.star_corner), filled.topology.stars().group(v));
  for (std::size_t k = 0; k < star.size(); ++k) {
    if (filled.corner_vertex[next_corner(star[k])] == u) return static_cast<Index>(k);
  }
  return static_cast<Index>(star.size());
}

AngleRow straight_row(const FilledSurface& filled, const Body& body, std::size_t i) {
  const Index v = body.vertex[i];
  const Index ahead = place_of_edge(filled, v, body.vertex[i + 1]),
              behind = place_of_edge(filled, v, body.vertex[i - 1]);
  const Index star = filled.topology.star_begin[v + 1] - filled.topology.star_begin[v];
  AngleRow row{.kind = AngleRow::Kind::Sum, .target = kPi, .constraint = body.constraint};
  if (filled.topology.is_boundary(v)) {
    row.first = std::min(ahead, behind);
    row.count = std::max(ahead, behind) - row.first;
  } else {
    row.first = ahead;
    row.count = (behind - ahead + star) % star;
  }
  return row;
}

/// The way from half-edge to half-edge, as a sum of turns.
class Turns {
 public:
  explicit Turns(const FilledSurface& filled) : filled_(filled) {}

  /// Within a triangle.
  void turn(Index from, Index to) {
    const Index first = std::min(from, to), last = std::max(from, to), sign = from <= to ? 1 : -1;
    for (Index k = first; k < last; ++k) {
      terms_[next_corner(k)] -= sign;
      constant_ += sign * kPi;
    }
  }
  void turn_round() { constant_ += kPi; }

  LongAngleRow row() const {
    LongAngleRow result{.terms = {}, .target = -constant_};
    for (const auto& [corner, factor] : terms_) {
      if (factor != 0) result.terms.push_back({corner, factor});
    }
    return result;
  }

 private:
  const FilledSurface& filled_;
  std::map<Index, double> terms_;
  double constant_ = 0;
};

/// Half-edges along the edges of a body, and whether each runs with it.
std::vector<std::pair<Index, bool>> half_edges(const FilledSurface& filled, const Body& body) {
  std::vector<std::pair<Index, bool>> result;
  for (std::size_t i = 0; i < body.num_edges(); ++i) {
    const Index u = body.vertex[i], v = body.vertex[(i + 1) % body.vertex.size()];
    if (const Index c = half_edge_of(filled, u, v); c != kNone) result.emplace_back(c, true);
    if (const Index c = half_edge_of(filled, v, u); c != kNone) result.emplace_back(c, false);
  }
  return result;
}

}  // namespace

std::vector<std::pair<Index, AngleRow>> straight_rows(const FilledSurface& filled, const Compiled& compiled) {
  std::vector<std::pair<Index, AngleRow>> rows;
  for (const Body& body : compiled.bodies) {
    if (body.kind == Body::Kind::Chord) continue;
    for (std::size_t i = 1; i + 1 < body.vertex.size(); ++i)
      rows.emplace_back(body.vertex[i], straight_row(filled, body, i));
  }
  return rows;
}

std::optional<LongAngleRow> direction_row(const FilledSurface& filled, const Compiled& compiled, Index a,
                                          Index b) {
  constexpr Index kUnseen = -2;
  std::vector<Index> entered(filled.num_triangles(), kUnseen);  // by which half-edge
  std::vector<Index> queue;
  std::map<Index, std::pair<Index, bool>> start, goal;  // of a triangle
  for (const auto& h : half_edges(filled, compiled.bodies[a])) {
    if (start.emplace(h.first / 3, h).second) queue.push_back(h.first / 3);
  }
  for (const auto& h : half_edges(filled, compiled.bodies[b])) goal.emplace(h.first / 3, h);
  for (const Index t : queue) entered[t] = kNone;
  Index last = kNone;
  for (std::size_t head = 0; head < queue.size() && last == kNone; ++head) {
    const Index t = queue[head];
    if (goal.contains(t)) last = t;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const Index twin = filled.topology.corner_twin[c];
      if (twin == kNone || entered[twin / 3] != kUnseen) continue;
      entered[twin / 3] = twin;
      queue.push_back(twin / 3);
    }
  }
  if (last == kNone) return std::nullopt;
  std::vector<Index> way(1, last);  // triangles, the last one first
  while (entered[way.back()] != kNone) way.push_back(filled.topology.corner_twin[entered[way.back()]] / 3);
  std::reverse(way.begin(), way.end());
  Turns turns(filled);
  Index at = start.at(way.front()).first;
  if (!start.at(way.front()).second) turns.turn_round();
  for (std::size_t k = 1; k < way.size(); ++k) {
    const Index entry = entered[way[k]];
    turns.turn(at, filled.topology.corner_twin[entry]);
    turns.turn_round();
    at = entry;
  }
  turns.turn(at, goal.at(last).first);
  if (!goal.at(last).second) turns.turn_round();
  return turns.row();
}

std::vector<LongAngleRow> relation_rows(const FilledSurface& filled, const Compiled& compiled,
                                        In<double> chosen, In<double> angle) {
  std::vector<LongAngleRow> rows;
  std::map<Index, std::pair<Index, double>> directed;  // of a component: a body and its direction
  const auto add = [&](Index relation, Index a, Index b, double degrees) {
    auto row = direction_row(filled, compiled, a, b);
    if (!row) return;  // between components: turned as a whole
    double now = -row->target;
    for (const LongAngleRow::Term& term : row->terms) now += term.factor * angle[term.corner];
    row->target += degrees + 2 * kPi * std::round((now - degrees) / (2 * kPi));
    row->relation = relation;
    rows.push_back(std::move(*row));
  };
  for (Index k = 0; k < static_cast<Index>(compiled.relations.size()); ++k) {
    const Relation& relation = compiled.relations[k];
    if (relation.a != kNone) {
      add(k, relation.a, relation.b, chosen[k]);
      continue;
    }
    const Index c =
        filled.topology.star_corner[filled.topology.star_begin[compiled.bodies[relation.b].vertex.front()]];
    const Index component = filled.topology.triangle_component[c / 3];
    const auto [first, is_new] = directed.emplace(component, std::pair(relation.b, chosen[k]));
    if (!is_new) add(k, first->second.first, relation.b, chosen[k] - first->second.second);
  }
  return rows;
}

}  // namespace planish
