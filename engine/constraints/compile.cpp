#include "engine/constraints/compile.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "engine/constraints/chain_shape.hpp"
#include "engine/features/one_ring.hpp"

namespace planish {
namespace {

class Compiler {
 public:
  Compiler(const RestSurface& rest, const ConstraintView& view, const RegionMap& map)
      : rest_(rest), view_(view), map_(map), chirality_(rest) {
    for (Index f = 0; f < static_cast<Index>(view.features.size()); ++f)
      instances_[view.features[f].name].push_back(f);
    for (const Constraint& c : view.set->constraints) {
      if (const auto* line = std::get_if<LineConstraint>(&c.rule)) lines_.insert(line->feature);
    }
  }

  Result<Compiled> operator()() {
    for (at_ = 0; at_ < static_cast<Index>(view_.set->constraints.size()); ++at_) {
      auto done = std::visit([&](const auto& rule) { return add(rule); }, view_.set->constraints[at_].rule);
      if (!done) return fail(done.error());
    }
    // Relations may speak of shapes that come later in the file.
    for (at_ = 0; at_ < static_cast<Index>(view_.set->constraints.size()); ++at_) {
      const auto& rule = view_.set->constraints[at_].rule;
      Result<void> done;
      if (const auto* angle = std::get_if<AngleConstraint>(&rule)) done = relate(*angle);
      if (const auto* direction = std::get_if<DirectionConstraint>(&rule)) done = relate(*direction);
      if (!done) return fail(done.error());
    }
    return std::move(result_);
  }

 private:
  Failure invalid(const std::string& what) const {
    return fail(constraint_error(ErrorCode::ConstraintInvalid, *view_.set, at_, what));
  }

  Result<std::vector<Index>> instances(const std::string& name) const {
    const auto found = instances_.find(name);
    if (found == instances_.end()) return invalid("no feature is called \"" + name + "\"");
    return found->second;
  }

  // ---- shapes ----

  Result<void> add(const LineConstraint& rule) { return add_chain(rule, make_line); }
  Result<void> add(const CircleConstraint& rule) { return add_chain(rule, make_circle); }
  Result<void> add(const CurveConstraint& rule) { return add_chain(rule, make_curve); }
  Result<void> add(const AngleConstraint&) { return {}; }
  Result<void> add(const DirectionConstraint&) { return {}; }

  template <class Rule>
  Result<void> add_chain(const Rule& rule, Result<void> (*make)(const ChainInput&, const Rule&, Body&)) {
    const auto found = instances(rule.feature);
    if (!found) return fail(found.error());
    for (const Index f : *found) {
      const Feature& chain = view_.features[f];
      if (chain.is_region()) return invalid("\"" + chain.name + "\" is a region, and a curve is needed");
      if (auto simple = check_simple(chain); !simple) return simple;
      Body body{.constraint = at_, .feature = f, .vertex = chain.vertex, .closed = chain.closed};
      const std::vector<double> length = edge_lengths(rest_, chain.vertex, chain.closed);
      body.size = std::accumulate(length.begin(), length.end(), 0.0);
      auto made = make({&rest_, view_.set, at_, &chain, &chirality_}, rule, body);
      if (!made) return made;
      result_.bodies.push_back(std::move(body));
    }
    return {};
  }

  Result<void> check_simple(const Feature& chain) const {
    std::vector<Index> sorted = chain.vertex;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice == sorted.end()) return {};
    Error error = constraint_error(ErrorCode::ConstraintInvalid, *view_.set, at_,
                                   "\"" + chain.name + "\" passes a vertex twice, and has no template");
    error.element = ElementKind::Vertex;
    error.ids = {view_.origin_of(rest_.mesh->vertex_origin[*twice])};
    error.count = 1;
    return fail(error);
  }

  Result<void> add(const RegionConstraint& rule) {
    const auto found = instances(rule.feature);
    if (!found) return fail(found.error());
    for (const Index f : *found) {
      const Feature& feature = view_.features[f];
      if (!feature.is_region()) return invalid("\"" + feature.name + "\" is a curve, and a region is needed");
      Body body{.kind = Body::Kind::Region, .constraint = at_, .feature = f, .triangle = feature.triangle};
      body.scale = rule.scale.factor;
      body.scale_group = rule.scale.group;
      double region_area = 0;
      for (const Index t : body.triangle) region_area += area(rest_.frame[t]);
      body.size = std::sqrt(region_area);
      if (auto made = make_region(rest_, *view_.set, map_, body); !made) return made;
      result_.bodies.push_back(std::move(body));
    }
    return {};
  }

  /// The vertices' numbers are those of the ordered mesh already; on a seam a vertex has several copies.
  Result<void> add(const PinConstraint& rule) {
    for (std::size_t i = 0; i < rule.vertex.size(); ++i) {
      const Vec2 uv = (1 / rest_.mesh->unit) * rule.uv[i];
      const std::vector<Index> found = copies(rule.vertex[i]);
      if (found.empty())
        return invalid("vertex " + std::to_string(rule.vertex[i]) + " is part of no triangle");
      for (const Index v : found) {
        const auto same = std::find_if(result_.pins.begin(), result_.pins.end(),
                                       [&](const Pin& p) { return p.vertex == v; });
        if (same == result_.pins.end()) {
          result_.pins.push_back({at_, v, uv});
        } else if (!(norm(same->uv - uv) <= 1e-12)) {
          return fail(conflict(*view_.set, {same->constraint, at_},
                               "vertex " + std::to_string(rule.vertex[i]) + " is pinned to two places"));
        }
      }
    }
    return {};
  }

  /// Of a vertex of the input in the ordered mesh.
  std::vector<Index> copies(Index input_vertex) {
    if (by_input_.empty()) {
      for (Index v = 0; v < rest_.mesh->num_vertices(); ++v)
        by_input_.emplace_back(view_.origin_of(rest_.mesh->vertex_origin[v]), v);
      std::sort(by_input_.begin(), by_input_.end());
    }
    std::vector<Index> found;
    for (auto k = std::lower_bound(by_input_.begin(), by_input_.end(), std::pair(input_vertex, Index{0}));
         k != by_input_.end() && k->first == input_vertex; ++k)
      found.push_back(k->second);
    return found;
  }

  // ---- relations ----

  struct Measured {
    Index body = kNone;
    double along = 0;
    int side = 0;
  };

  Result<void> relate(const AngleConstraint& rule) {
    std::vector<std::vector<Measured>> end(2);
    for (std::size_t k = 0; k < 2; ++k) {
      auto found =
          rule.features.empty() ? measured_edge(rule.edges[k]) : measured(rule.features[k], rule.measure);
      if (!found) return fail(found.error());
      end[k] = std::move(*found);
    }
    for (const Measured& a : end[0]) {
      for (const Measured& b : end[1]) {
        if (a.side != 0 && b.side != 0 && a.side != b.side) continue;
        if (a.body == b.body) return invalid("what it relates is one and the same");
        result_.relations.push_back(
            {at_, a.body, b.body, a.along, b.along, rule.degrees, rule.oriented, std::max(a.side, b.side)});
      }
    }
    return {};
  }

  Result<void> relate(const DirectionConstraint& rule) {
    auto found = rule.edge ? measured_edge(*rule.edge) : measured(rule.feature, rule.measure);
    if (!found) return fail(found.error());
    for (const Measured& m : *found)
      result_.relations.push_back({at_, kNone, m.body, 0, m.along, rule.degrees, rule.oriented, m.side});
    return {};
  }

  Result<std::vector<Measured>> measured(const std::string& feature, std::optional<Measure> measure) {
    const auto found = instances(feature);
    if (!found) return fail(found.error());
    const bool is_line = lines_.contains(feature);
    if (measure == Measure::Line && !is_line)
      return invalid("\"" + feature + "\" is to be measured as a line, but no constraint makes it one");
    const bool as_line = measure.value_or(is_line ? Measure::Line : Measure::Chord) == Measure::Line;
    std::vector<Measured> result;
    for (const Index f : *found) {
      const Feature& chain = view_.features[f];
      if (chain.is_region()) return invalid("\"" + feature + "\" is a region, which has no direction");
      if (chain.closed) return invalid("\"" + feature + "\" is closed, and has no direction");
      Index best = kNone;
      for (Index b = 0; b < static_cast<Index>(result_.bodies.size()); ++b) {
        const Body& body = result_.bodies[b];
        if (body.feature == f && (best == kNone || (as_line && body.is_straight()))) best = b;
      }
      if (best == kNone) best = add_chord(f, {chain.vertex.front(), chain.vertex.back()});
      const std::vector<Vec2>& shape = result_.bodies[best].shape;
      result.push_back({best, argument(shape.back() - shape.front()), chain.side});
    }
    return result;
  }

  Result<std::vector<Measured>> measured_edge(const std::array<Index, 2>& edge) {
    std::vector<Measured> result;
    const std::vector<Index> tails = copies(edge[0]), heads = copies(edge[1]);
    for (const Index u : tails) {
      for (const Index v : heads) {
        if (share_edge(rest_.surface(), *rest_.topology, u, v))
          result.push_back({add_chord(kNone, {u, v}), 0, 0});
      }
    }
    if (result.size() == 2) {  // both sides of a seam
      const std::vector<Index>& first = result_.bodies[result[0].body].vertex;
      const bool left = half_edge(rest_.surface(), *rest_.topology, first[0], first[1]) != kNone;
      result[0].side = left ? 1 : 2;
      result[1].side = left ? 2 : 1;
    }
    if (result.empty()) {
      return invalid("the mesh has no edge " + std::to_string(edge[0]) + "-" + std::to_string(edge[1]) +
                     "; if a feature cut it, make a feature of it");
    }
    return result;
  }

  /// A line of free scale between two vertices; the same one for all constraints that measure it.
  Index add_chord(Index feature, const std::array<Index, 2>& ends) {
    for (Index b = 0; b < static_cast<Index>(result_.bodies.size()); ++b) {
      const Body& body = result_.bodies[b];
      if (body.kind == Body::Kind::Chord && body.vertex[0] == ends[0] && body.vertex[1] == ends[1]) return b;
    }
    const auto& position = rest_.mesh->position;
    Body body{.kind = Body::Kind::Chord, .constraint = at_, .feature = feature, .vertex = {ends[0], ends[1]}};
    body.size = norm(position[ends[1]] - position[ends[0]]);
    constexpr double kSamePlace = 1e-6;
    if (body.size < kSamePlace) body.size = 1;  // the scale is free, so any size will do
    body.shape = {{-0.5 * body.size, 0}, {0.5 * body.size, 0}};
    body.scale = std::nullopt;
    body.adjacent = share_edge(rest_.surface(), *rest_.topology, ends[0], ends[1]);
    result_.bodies.push_back(std::move(body));
    return static_cast<Index>(result_.bodies.size()) - 1;
  }

  const RestSurface& rest_;
  const ConstraintView& view_;
  const RegionMap& map_;
  Chirality chirality_;
  std::map<std::string, std::vector<Index>> instances_;
  std::set<std::string> lines_;
  std::vector<std::pair<Index, Index>> by_input_;  // vertex of the input, vertex here; filled when needed
  Index at_ = 0;
  Compiled result_;
};

}  // namespace

Result<Compiled> compile(const RestSurface& rest, const ConstraintView& view, const RegionMap& map) {
  return Compiler(rest, view, map)();
}

}  // namespace planish
