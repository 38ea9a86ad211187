#include "engine/constraints/chirality.hpp"

#include <algorithm>

#include "engine/features/one_ring.hpp"

namespace planish {

Chirality::Chirality(const RestSurface& rest)
    : rest_(rest),
      label_(rest.topology->corner_twin.size() / 3, kNone),
      barred_(rest.topology->corner_twin.size(), kNone) {}

bool Chirality::is_outer_edge(Index corner) const {
  const Topology& topology = *rest_.topology;
  if (topology.corner_twin[corner] != kNone || barred_[corner] == number_) return false;
  const Index loop = rest_.loop_of[rest_.mesh->corner_vertex[corner]];
  return loop == rest_.outer_loop[topology.triangle_component[corner / 3]];
}

void Chirality::start(In<Index> chain) {
  ++number_;
  left_ = right_ = {};
  const Surface surface = rest_.surface();
  std::vector<Index> left_seed, right_seed;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Index u = chain[i], v = chain[(i + 1) % chain.size()];
    const Index there = half_edge(surface, *rest_.topology, u, v);
    const Index back = half_edge(surface, *rest_.topology, v, u);
    for (const Index c : {there, back}) {
      if (c != kNone) barred_[c] = number_;
    }
    if (there != kNone) left_seed.push_back(there / 3);
    if (back != kNone) right_seed.push_back(back / 3);
  }
  const auto seed = [&](Side& side, const std::vector<Index>& seeds, Index label) {
    for (const Index t : seeds) {
      if (label_[t] == label) continue;
      label_[t] = label;
      side.queue.push_back(t);
    }
  };
  seed(left_, left_seed, 2 * number_);
  seed(right_, right_seed, 2 * number_ + 1);
}

bool Chirality::step(Side& side, Index label) {
  const Index other = label ^ 1;
  const Index t = side.queue[side.head++];
  if (label_[t] == other) return false;  // the two sides are one
  for (Index c = 3 * t; c < 3 * t + 3; ++c) {
    side.outer = side.outer || is_outer_edge(c);
    const Index twin = rest_.topology->corner_twin[c];
    if (twin == kNone || barred_[c] == number_ || label_[twin / 3] == label) continue;
    if (label_[twin / 3] == other) return false;
    label_[twin / 3] = label;
    side.queue.push_back(twin / 3);
  }
  return true;
}

std::optional<bool> Chirality::counter_clockwise(In<Index> chain) {
  const Surface surface = rest_.surface();
  const auto is_outer = [&](Index tail, Index head) {
    const Index c = half_edge(surface, *rest_.topology, tail, head);
    return c != kNone && is_outer_edge(c);
  };
  const auto all_outer = [&](bool forwards) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Index u = chain[i], v = chain[(i + 1) % chain.size()];
      if (!(forwards ? is_outer(u, v) : is_outer(v, u))) return false;
    }
    return true;
  };
  ++number_;
  if (all_outer(true)) return true;
  if (all_outer(false)) return false;
  start(chain);
  // Both floods keep pace, so that the work is that of the smaller side. A flood that reached the outer loop may still
  // meet the other one.
  while (true) {
    if (right_.exhausted()) return right_.outer;
    if (left_.exhausted()) return !left_.outer;
    if (!step(left_, 2 * number_) || !step(right_, 2 * number_ + 1)) return std::nullopt;
  }
}

Vec3 mean_normal(const RestSurface& rest, In<Index> chain, bool closed) {
  const Surface surface = rest.surface();
  Vec3 sum{};
  for (std::size_t i = 0; i + (closed ? 0 : 1) < chain.size(); ++i) {
    const Index u = chain[i], v = chain[(i + 1) % chain.size()];
    const double length = norm(surface.position[v] - surface.position[u]);
    for (const Index c :
         {half_edge(surface, *rest.topology, u, v), half_edge(surface, *rest.topology, v, u)}) {
      if (c == kNone) continue;
      const auto corner = [&](Index k) { return surface.position[surface.corner_vertex[k]]; };
      const Index first = 3 * (c / 3);
      const Vec3 n = cross(corner(first + 1) - corner(first), corner(first + 2) - corner(first));
      sum = sum + (length / norm(n)) * n;
    }
  }
  const double size = norm(sum);
  return size > 0 ? (1 / size) * sum : sum;
}

double doubled_area(In<Vec2> polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    sum += cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
  }
  return sum;
}

}  // namespace planish
