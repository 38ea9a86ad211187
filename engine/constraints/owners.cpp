#include "engine/constraints/owners.hpp"

#include <algorithm>

namespace planish {

std::vector<Owner> find_owners(const Compiled& compiled, const Agreement& agreement) {
  const std::vector<Body>& bodies = compiled.bodies;
  std::vector<Owner> owners;
  for (Index b = 0; b < static_cast<Index>(bodies.size()); ++b) {
    for (Index i = 0; i < static_cast<Index>(bodies[b].vertex.size()); ++i) {
      if (!agreement.yielded[b][i]) owners.push_back({bodies[b].vertex[i], b, i});
    }
  }
  std::sort(owners.begin(), owners.end(), [&](const Owner& x, const Owner& y) {
    if (x.vertex != y.vertex) return x.vertex < y.vertex;
    const Body &a = bodies[x.body], &b = bodies[y.body];
    if (rank_of(a.kind) != rank_of(b.kind)) return rank_of(a.kind) > rank_of(b.kind);
    return a.size != b.size ? a.size > b.size : x.body < y.body;
  });
  owners.erase(std::unique(owners.begin(), owners.end(),
                           [](const Owner& x, const Owner& y) { return x.vertex == y.vertex; }),
               owners.end());
  return owners;
}

Restricted restrict_to(const Compiled& compiled, const std::vector<std::uint8_t>& keep_constraint) {
  Restricted result;
  const std::size_t n = compiled.bodies.size();
  std::vector<std::uint8_t> keep(n, 0);
  for (std::size_t b = 0; b < n; ++b) {
    const Body& body = compiled.bodies[b];
    keep[b] = body.kind != Body::Kind::Chord && keep_constraint[body.constraint];
  }
  const auto measured = [&](const Relation& r) {
    const auto there = [&](Index b) {
      return b == kNone || keep[b] || compiled.bodies[b].kind == Body::Kind::Chord;
    };
    return keep_constraint[r.constraint] && there(r.a) && there(r.b);
  };
  for (const Relation& r : compiled.relations) {
    if (!measured(r)) continue;
    for (const Index b : {r.a, r.b}) {
      if (b != kNone) keep[b] = 1;
    }
  }
  result.body.assign(n, kNone);
  for (std::size_t b = 0; b < n; ++b) {
    if (!keep[b]) continue;
    result.body[b] = static_cast<Index>(result.compiled.bodies.size());
    result.compiled.bodies.push_back(compiled.bodies[b]);
  }
  for (const Relation& r : compiled.relations) {
    if (!measured(r)) continue;
    Relation kept = r;
    for (Index* b : {&kept.a, &kept.b}) *b = *b == kNone ? kNone : result.body[*b];
    result.compiled.relations.push_back(kept);
  }
  for (const Pin& pin : compiled.pins) {
    if (keep_constraint[pin.constraint]) result.compiled.pins.push_back(pin);
  }
  return result;
}

}  // namespace planish
