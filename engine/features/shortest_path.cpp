#include "engine/features/shortest_path.hpp"

#include <algorithm>

#include "engine/features/one_ring.hpp"

namespace planish {

ShortestPaths::ShortestPaths(const Surface& surface, const Topology& topology)
    : surface_(surface),
      topology_(topology),
      length_(surface.position.size(), kInfinity),
      came_from_(surface.position.size(), kNone) {}

void ShortestPaths::reach(Index v, Index from, double length, Vec3 goal) {
  if (length >= length_[v]) return;
  if (length_[v] == kInfinity) touched_.push_back(v);
  length_[v] = length;
  came_from_[v] = from;
  open_.push_back({length + norm(goal - surface_.position[v]), length, v});
  std::push_heap(open_.begin(), open_.end(), later);
}

bool ShortestPaths::search(Index from, Index to, In<std::uint8_t> barred) {
  const Vec3 goal = surface_.position[to];
  reach(from, kNone, 0, goal);
  while (!open_.empty()) {
    std::pop_heap(open_.begin(), open_.end(), later);
    const Open best = open_.back();
    open_.pop_back();
    if (best.vertex == to) return true;
    if (best.length > length_[best.vertex]) continue;  // a shorter way was found since
    const Vec3 here = surface_.position[best.vertex];
    for_each_neighbour(surface_, topology_, best.vertex, [&](Index w) {
      if (w != to && !barred.empty() && barred[w]) return;
      reach(w, best.vertex, best.length + norm(surface_.position[w] - here), goal);
    });
  }
  return false;
}

void ShortestPaths::forget() {
  for (const Index v : touched_) length_[v] = kInfinity;
  touched_.clear();
  open_.clear();
}

std::vector<Index> ShortestPaths::find(Index from, Index to, In<std::uint8_t> barred) {
  std::vector<Index> path;
  if (search(from, to, barred)) {
    for (Index v = to; v != from; v = came_from_[v]) path.push_back(v);
    std::reverse(path.begin(), path.end());
  }
  forget();
  return path;
}

}  // namespace planish
