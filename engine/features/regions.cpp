#include "engine/features/regions.hpp"

#include <algorithm>

#include "engine/features/feature_error.hpp"

namespace planish {
namespace {

Error broken(const std::string& name, const std::string& what) {
  return feature_error(ErrorCode::RegionBroken, name, what);
}

/// Turns state 1 into 2 for the triangles of the list connected to t; returns nothing new.
void flood(const Topology& topology, Index t, std::vector<std::uint8_t>& state, std::vector<Index>& queue) {
  queue.assign(1, t);
  state[t] = 2;
  while (!queue.empty()) {
    const Index here = queue.back();
    queue.pop_back();
    for (Index c = 3 * here; c < 3 * here + 3; ++c) {
      const Index twin = topology.corner_twin[c];
      if (twin == kNone || state[twin / 3] != 1) continue;
      state[twin / 3] = 2;
      queue.push_back(twin / 3);
    }
  }
}

}  // namespace

Result<std::vector<Index>> region_of_triangles(const Surface& surface, const Topology& topology,
                                               const std::string& name, const TriangleSource& source) {
  if (source.triangle.empty()) return fail(broken(name, "has no triangles"));
  OffendingIds outside;
  std::size_t first = source.triangle.size();
  for (std::size_t i = 0; i < source.triangle.size(); ++i) {
    if (source.triangle[i] >= 0 && source.triangle[i] < surface.num_triangles()) continue;
    outside.add(source.triangle[i]);
    first = std::min(first, i);
  }
  if (!outside.empty()) {
    const std::string what = "names triangle " + std::to_string(outside.first()) + ", but the mesh has " +
                             std::to_string(surface.num_triangles()) + " triangles, counted from 0";
    Error error = outside.of(feature_error(ErrorCode::RegionBroken, name, what), ElementKind::Triangle);
    error.place.pointer += "/triangles/" + std::to_string(first);
    return fail(error);
  }
  std::vector<Index> sorted = source.triangle;
  std::sort(sorted.begin(), sorted.end());
  OffendingIds repeated;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i] == sorted[i - 1] && (i < 2 || sorted[i] != sorted[i - 2])) repeated.add(sorted[i]);
  }
  if (!repeated.empty())
    return fail(repeated.of(broken(name, "lists triangles several times"), ElementKind::Triangle));
  std::vector<std::uint8_t> state(surface.num_triangles(), 0);
  for (const Index t : sorted) state[t] = 1;
  OffendingIds pieces;
  std::vector<Index> queue;
  for (const Index t : sorted) {
    if (state[t] != 1) continue;
    pieces.add(t);
    flood(topology, t, state, queue);
  }
  if (pieces.count() == 1) return sorted;
  const std::string what = "is in " + std::to_string(pieces.count()) +
                           " pieces that share no edge, each listed by one triangle; make a feature of each";
  return fail(pieces.of(broken(name, what), ElementKind::Triangle));
}

}  // namespace planish
