#include "engine/methods/scale_boundary.hpp"

#include <algorithm>
#include <map>

#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

/// A stretch of an outer loop between two lines: from the end of one to the beginning of the next, both included.
struct Arc {
  std::vector<Index> vertex;
  double turning_target = 0;  // radians, of all its vertices together
};

class Boundary {
 public:
  Boundary(const FilledSurface& filled, const ConstraintView& view, const Compiled& compiled)
      : filled_(filled), view_(view), compiled_(compiled), place_(filled.num_vertices, kNone) {
    for (Index l = 0; l < filled.topology.num_loops(); ++l) {
      Index place = 0;
      for (const Index c : loop(l)) place_[filled.corner_vertex[c]] = place++;
    }
  }

  Result<void> check() const {
    for (const Body& body : compiled_.bodies) {
      if (on_boundary(body)) continue;
      return fail(constraint_error(
          ErrorCode::ConstraintUnsupported, *view_.set, body.constraint,
          "\"" + name_of(body) +
              "\" does not run along the outer boundary, and a conformal map is unique up to what is "
              "asked for there"));
    }
    return {};
  }

  Result<ScaleNodes> nodes(In<double> chosen, In<double> angle_sum) {
    nodes_.node.resize(filled_.num_vertices);
    nodes_.target.assign(filled_.num_vertices, 0);
    nodes_.num_nodes = filled_.num_vertices;
    for (Index v = 0; v < filled_.num_vertices; ++v) {
      nodes_.node[v] = filled_.topology.is_boundary(v) ? kNone : v;
      nodes_.target[v] = 2 * kPi;
    }
    for (const Body& body : compiled_.bodies) {
      for (std::size_t i = 1; i + 1 < body.vertex.size(); ++i) {
        nodes_.node[body.vertex[i]] = body.vertex[i];
        nodes_.target[body.vertex[i]] = kPi;
      }
    }
    if (!chosen.empty()) {
      if (auto tied = tie_relations(chosen, angle_sum); !tied) return fail(tied.error());
    }
    return std::move(nodes_);
  }

 private:
  In<Index> loop(Index l) const {
    return slice(In<Index>(filled_.topology.loop_corner), filled_.topology.loops().group(l));
  }
  Index loop_of(Index v) const {
    const Index c = filled_.topology.star_corner[filled_.topology.star_begin[v]];
    for (Index l = 0; l < filled_.topology.num_loops(); ++l) {
      if (filled_.topology.triangle_component[loop(l).front() / 3] ==
          filled_.topology.triangle_component[c / 3])
        return l;
    }
    return kNone;
  }

  bool on_boundary(const Body& body) const {
    if (!body.has_edges()) return false;
    for (const Index v : body.vertex) {
      if (place_[v] == kNone) return false;
    }
    for (std::size_t i = 0; i + 1 < body.vertex.size(); ++i) {
      if (steps(body.vertex[i], body.vertex[i + 1]) != 1 && steps(body.vertex[i + 1], body.vertex[i]) != 1)
        return false;
    }
    return true;
  }

  std::string name_of(const Body& body) const {
    return body.feature == kNone ? view_.set->constraints[body.constraint].name
                                 : view_.features[body.feature].name;
  }

  /// Along the loop from one vertex to another.
  Index steps(Index from, Index to) const {
    const auto size = static_cast<Index>(loop(loop_of(from)).size());
    return (place_[to] - place_[from] + size) % size;
  }

  bool runs_with_loop(const Body& body) const { return steps(body.vertex[0], body.vertex[1]) == 1; }
  Index first_along(const Body& body) const {
    return runs_with_loop(body) ? body.vertex.front() : body.vertex.back();
  }
  Index last_along(const Body& body) const {
    return runs_with_loop(body) ? body.vertex.back() : body.vertex.front();
  }

  /// From body a on to body b; direction: of b against a, both as they run along the loop.
  Arc arc(const Body& a, const Body& b, double direction, In<double> angle_sum) const {
    const In<Index> corners = loop(loop_of(a.vertex.front()));
    Arc result;
    const Index first = place_[last_along(a)], count = steps(last_along(a), first_along(b)) + 1;
    double now = 0;
    for (Index k = 0; k < count; ++k) {
      const Index v = filled_.corner_vertex[corners[(first + k) % static_cast<Index>(corners.size())]];
      const bool given = nodes_.node[v] == v;
      if (given) {
        direction -= kPi - nodes_.target[v];
      } else {
        result.vertex.push_back(v);
        now += kPi - angle_sum[v];
      }
    }
    result.turning_target = direction + 2 * kPi * std::round((now - direction) / (2 * kPi));
    return result;
  }

  bool is_free(const Arc& arc) const {
    return !arc.vertex.empty() && std::all_of(arc.vertex.begin(), arc.vertex.end(),
                                              [&](Index v) { return nodes_.node[v] == kNone; });
  }
  bool leaves_ground(const Arc& arc) const {
    const In<Index> corners = loop(loop_of(arc.vertex.front()));
    const auto free = std::count_if(corners.begin(), corners.end(),
                                    [&](Index c) { return nodes_.node[filled_.corner_vertex[c]] == kNone; });
    return free > static_cast<std::ptrdiff_t>(arc.vertex.size());
  }

  /// Nothing is left to choose where the rest of the loop is asked for: the relation must follow from the others.
  Result<void> tie(Index relation, const Body& a, const Body& b, double chosen, In<double> angle_sum) {
    const double along = chosen + (runs_with_loop(a) ? 0 : kPi) + (runs_with_loop(b) ? 0 : kPi);
    Arc ways[] = {arc(a, b, reduce_angle(along), angle_sum), arc(b, a, reduce_angle(-along), angle_sum)};
    if (ways[1].vertex.size() < ways[0].vertex.size()) std::swap(ways[0], ways[1]);
    for (const Arc& way : ways) {
      if (!is_free(way) || !leaves_ground(way)) continue;
      if (way.vertex.size() == 1) {
        nodes_.node[way.vertex[0]] = way.vertex[0];
        nodes_.target[way.vertex[0]] = kPi - way.turning_target;
      } else {
        for (const Index v : way.vertex) nodes_.node[v] = nodes_.num_nodes;
        nodes_.target.push_back(kPi * static_cast<double>(way.vertex.size()) - way.turning_target);
        ++nodes_.num_nodes;
      }
      return {};
    }
    const bool closes =
        std::any_of(std::begin(ways), std::end(ways), [&](const Arc& way) { return is_free(way); });
    if (closes) return {};  // checked by its residual
    return fail(constraint_error(
        ErrorCode::ConstraintsConflict, *view_.set, compiled_.relations[relation].constraint,
        "both ways along the outer boundary between what it relates have vertices whose angles "
        "another relation ties; relate neighbours along the boundary"));
  }

  Result<void> tie_relations(In<double> chosen, In<double> angle_sum) {
    std::map<Index, std::pair<Index, double>> directed;  // of a loop: a body and its direction
    for (Index k = 0; k < static_cast<Index>(compiled_.relations.size()); ++k) {
      const Relation& relation = compiled_.relations[k];
      Index a = relation.a;
      double direction = chosen[k];
      const Index mine = loop_of(compiled_.bodies[relation.b].vertex.front());
      if (a == kNone) {
        const auto [first, is_new] = directed.emplace(mine, std::pair(relation.b, direction));
        if (is_new) continue;
        a = first->second.first;
        direction -= first->second.second;
      }
      if (loop_of(compiled_.bodies[a].vertex.front()) != mine)
        continue;  // between components: turned as a whole
      auto tied = tie(k, compiled_.bodies[a], compiled_.bodies[relation.b], direction, angle_sum);
      if (!tied) return tied;
    }
    return {};
  }

  const FilledSurface& filled_;
  const ConstraintView& view_;
  const Compiled& compiled_;
  std::vector<Index> place_;  // [V] along its loop, kNone inside
  ScaleNodes nodes_;
};

}  // namespace

Result<ScaleNodes> scale_nodes(const FilledSurface& filled, const ConstraintView& view,
                               const Compiled& compiled, In<double> chosen, In<double> angle_sum) {
  return Boundary(filled, view, compiled).nodes(chosen, angle_sum);
}

Result<void> check_on_boundary(const FilledSurface& filled, const ConstraintView& view,
                               const Compiled& compiled) {
  return Boundary(filled, view, compiled).check();
}

}  // namespace planish
