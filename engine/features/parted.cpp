#include "engine/features/parted.hpp"

#include <algorithm>
#include <set>

#include "engine/features/feature_error.hpp"
#include "engine/features/one_ring.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {
namespace {

std::set<std::string> named_by(const ConstraintSet& set) {
  std::set<std::string> names;
  for (const Constraint& constraint : set.constraints) {
    std::visit(
        [&](const auto& rule) {
          if constexpr (requires { rule.features; }) names.insert(rule.features.begin(), rule.features.end());
          if constexpr (requires { rule.feature; }) names.insert(rule.feature);
        },
        constraint.rule);
  }
  return names;
}

/// The chain on one side of the cut; the vertex of the input where it is torn, or kNone.
struct SideChain {
  std::vector<Index> vertex;
  Index torn = kNone;
};

SideChain side_chain(const Surface& surface, const Topology& topology, const Cut& cut, const Feature& chain,
                     bool left) {
  SideChain side;
  const std::size_t n = chain.vertex.size();
  const auto join = [&](Index copy, Index original) {
    if (side.vertex.back() != copy && side.torn == kNone) side.torn = original;
  };
  Index head = kNone;
  for (std::size_t i = 0; i + (chain.closed ? 0 : 1) < n; ++i) {
    const Index u = chain.vertex[i], v = chain.vertex[(i + 1) % n];
    const Index there = half_edge(surface, topology, u, v), back = half_edge(surface, topology, v, u);
    const bool forwards = back == kNone || (left && there != kNone);
    const Index c = forwards ? there : back;
    const Index tail = cut.corner_vertex[forwards ? c : next_corner(c)];
    head = cut.corner_vertex[forwards ? next_corner(c) : c];
    if (side.vertex.empty()) side.vertex.push_back(tail);
    join(tail, u);
    side.vertex.push_back(head);
  }
  if (chain.closed) {
    side.vertex.pop_back();
    if (head != side.vertex.front() && side.torn == kNone) side.torn = chain.vertex.front();
  }
  return side;
}

}  // namespace

Result<std::vector<Feature>> features_on_cut(const Exec& exec, const Surface& surface, const Cut& cut,
                                             const std::vector<Feature>& features, const ConstraintSet& set) {
  const Topology topology = build_topology(exec, surface);
  const std::set<std::string> named = named_by(set);
  std::vector<Feature> result;
  for (const Feature& feature : features) {
    const bool is_outer = feature.name == set.outer && !named.contains(feature.name);
    if (!named.contains(feature.name) && !is_outer) continue;
    if (feature.is_region()) {
      result.push_back(feature);
      continue;
    }
    SideChain left = side_chain(surface, topology, cut, feature, true);
    SideChain right = side_chain(surface, topology, cut, feature, false);
    for (const Index torn : {left.torn, right.torn}) {
      if (torn == kNone || is_outer) continue;
      Error error =
          feature_error(ErrorCode::ConstraintInvalid, feature.name,
                        "is cut apart by a seam that crosses it; constrain its parts as features of their "
                        "own, or lead the cut elsewhere");
      error.element = ElementKind::Vertex;
      error.ids = {torn};
      error.count = 1;
      return fail(error);
    }
    const bool parted = left.vertex != right.vertex && !is_outer;
    Feature copy = feature;
    copy.vertex = std::move(left.vertex);
    copy.side = parted ? 1 : 0;
    result.push_back(copy);
    if (!parted) continue;
    copy.vertex = std::move(right.vertex);
    copy.side = 2;
    result.push_back(std::move(copy));
  }
  return result;
}

std::vector<Vec2> shape_before_cut(const Cut& cut, In<Index> triangle, In<Vec2> shape) {
  std::vector<Index> corner;
  for (const Index t : triangle) {
    for (Index c = 3 * t; c < 3 * t + 3; ++c) corner.push_back(cut.corner_vertex[c]);
  }
  std::vector<Index> vertex = corner;
  std::sort(vertex.begin(), vertex.end());
  vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
  const auto point_of = [&](Index v) {
    return shape[std::lower_bound(vertex.begin(), vertex.end(), v) - vertex.begin()];
  };
  std::vector<std::pair<Index, Index>> by_origin;
  for (const Index v : vertex) by_origin.emplace_back(cut.vertex_origin[v], v);
  std::sort(by_origin.begin(), by_origin.end());
  const auto twice = std::adjacent_find(by_origin.begin(), by_origin.end(),
                                        [](const auto& x, const auto& y) { return x.first == y.first; });
  std::vector<Vec2> result;
  if (twice == by_origin.end()) {
    for (const auto& [origin, v] : by_origin) result.push_back(point_of(v));
  } else {
    for (const Index v : corner) result.push_back(point_of(v));
  }
  return result;
}

}  // namespace planish
