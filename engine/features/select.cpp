#include "engine/features/select.hpp"

#include <algorithm>
#include <optional>

#include "engine/features/feature_error.hpp"
#include "engine/features/nearest.hpp"
#include "engine/features/one_ring.hpp"
#include "engine/features/shortest_path.hpp"

namespace planish {
namespace {

using Fault = std::optional<Error>;

Error broken(const std::string& name, const std::string& what) {
  return feature_error(ErrorCode::FeatureBroken, name, what);
}

Fault out_of_range(const Surface& surface, const std::string& name, In<Index> list) {
  OffendingIds ids;
  std::size_t first = list.size();
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i] >= 0 && list[i] < surface.num_vertices()) continue;
    ids.add(list[i]);
    first = std::min(first, i);
  }
  if (ids.empty()) return {};
  const std::string what = "names vertex " + std::to_string(ids.first()) + ", but the mesh has " +
                           std::to_string(surface.num_vertices()) + " vertices, counted from 0";
  Error error = ids.of(feature_error(ErrorCode::FeatureBroken, name, what), ElementKind::Vertex);
  error.place.pointer += "/vertices/" + std::to_string(first);
  return error;
}

Fault too_short(const std::string& name, const VertexSource& source) {
  const std::size_t least = source.closed ? 3 : 2;
  if (source.vertex.size() >= least) return {};
  return broken(name, std::string(source.closed ? "a closed" : "an open") + " chain needs at least " +
                          std::to_string(least) + " vertices, " + std::to_string(source.vertex.size()) +
                          (source.vertex.size() == 1 ? " is given" : " are given"));
}

OffendingIds repeated_ids(In<Index> list) {
  std::vector<Index> sorted(list.begin(), list.end());
  std::sort(sorted.begin(), sorted.end());
  OffendingIds ids;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i] == sorted[i - 1] && (i < 2 || sorted[i] != sorted[i - 2])) ids.add(sorted[i]);
  }
  return ids;
}

/// The two ends are told apart from other repetitions: they have a remedy of their own.
Fault repeats(const std::string& name, const VertexSource& source) {
  const OffendingIds ids = repeated_ids(source.vertex);
  if (ids.empty()) return {};
  const bool only_ends = ids.count() == 1 && source.vertex.front() == source.vertex.back() &&
                         std::count(source.vertex.begin(), source.vertex.end(), source.vertex.front()) == 2;
  std::string what = "a chain passes each of its vertices once, and some are listed several times";
  if (only_ends && source.closed) {
    what = "the last vertex repeats the first; a closed feature does not repeat it: leave the last one out";
  } else if (only_ends) {
    what = "the last vertex is the first again; for a closed feature set \"closed\": true and leave it out";
  }
  return ids.of(broken(name, what), ElementKind::Vertex);
}

Fault unused(const Topology& topology, const std::string& name, In<Index> list) {
  OffendingIds ids;
  for (const Index v : list) {
    if (topology.star_begin[v] == topology.star_begin[v + 1]) ids.add(v);
  }
  if (ids.empty()) return {};
  return ids.of(broken(name, "names vertices that belong to no triangle"), ElementKind::Vertex);
}

Index component_of(const Topology& topology, Index v) {
  return topology.triangle_component[topology.star_corner[topology.star_begin[v]] / 3];
}

Fault several_components(const Topology& topology, const std::string& name, In<Index> list) {
  const Index first = component_of(topology, list.front());
  OffendingIds ids;
  for (const Index v : list) {
    if (component_of(topology, v) != first) ids.add(v);
  }
  if (ids.empty()) return {};
  const std::string what = "vertices " + std::to_string(list.front()) + " and " +
                           std::to_string(ids.first()) + " lie on different components of the surface; " +
                           "those not connected to the first one are listed";
  return ids.of(broken(name, what), ElementKind::Vertex);
}

Fault gaps(const Surface& surface, const Topology& topology, const std::string& name,
           const VertexSource& source) {
  const std::vector<Index>& list = source.vertex;
  OffendingIds edges;
  std::string first;
  for (std::size_t i = source.closed ? 0 : 1; i < list.size(); ++i) {
    const Index a = i == 0 ? list.back() : list[i - 1], b = list[i];
    if (share_edge(surface, topology, a, b)) continue;
    if (edges.empty()) first = std::to_string(a) + " and " + std::to_string(b);
    edges.add(a, b);
  }
  if (edges.empty()) return {};
  const std::string what = "consecutive vertices " + first +
                           " share no edge of the mesh; \"join\": \"shortest\" joins them by shortest paths";
  return edges.of(broken(name, what), ElementKind::Edge);
}

Fault fault_of_list(const Surface& surface, const Topology& topology, const std::string& name,
                    const VertexSource& source) {
  if (Fault f = too_short(name, source)) return f;
  if (Fault f = out_of_range(surface, name, source.vertex)) return f;
  if (Fault f = repeats(name, source)) return f;
  if (Fault f = unused(topology, name, source.vertex)) return f;
  if (Fault f = several_components(topology, name, source.vertex)) return f;
  return source.shortest ? std::nullopt : gaps(surface, topology, name, source);
}

/// Grows a chain by shortest paths that keep off what it has passed.
class Joiner {
 public:
  Joiner(const Surface& surface, const Topology& topology, const std::string& name, In<Index> list)
      : name_(name), paths_(surface, topology), use_(surface.position.size(), kFree), chain_{list.front()} {
    for (const Index v : list) use_[v] = kListed;
  }

  Fault join(Index from, Index to) {
    std::vector<Index> path = paths_.find(from, to, {});
    OffendingIds listed;
    bool meets_chain = false;
    for (const Index v : In<Index>(path).first(path.size() - 1)) {
      if (use_[v] == kListed) listed.add(v);
      meets_chain = meets_chain || use_[v] == kPassed;
    }
    if (!listed.empty()) return out_of_order(from, to, listed);
    if (meets_chain) path = paths_.find(from, to, use_);
    if (path.empty()) return shut_in(from, to);
    for (const Index v : path) {
      if (use_[v] == kFree) use_[v] = kPassed;
      chain_.push_back(v);
    }
    return {};
  }

  std::vector<Index> take_chain() { return std::move(chain_); }

 private:
  enum Use : std::uint8_t { kFree, kListed, kPassed };

  static std::string between(Index from, Index to) {
    return "from vertex " + std::to_string(from) + " to " + std::to_string(to);
  }
  Error out_of_order(Index from, Index to, const OffendingIds& listed) const {
    return listed.of(
        broken(name_, "the shortest path " + between(from, to) + " passes other vertices of the " +
                          "list; put the vertices in the order of the curve"),
        ElementKind::Vertex);
  }
  Error shut_in(Index from, Index to) const {
    OffendingIds ids;
    ids.add(from);
    ids.add(to);
    return ids.of(broken(name_, "every path " + between(from, to) + " meets the chain so far; put the " +
                                    "vertices in the order of the curve, or give more of them"),
                  ElementKind::Vertex);
  }

  const std::string& name_;
  ShortestPaths paths_;
  std::vector<std::uint8_t> use_;  ///< [V]
  std::vector<Index> chain_;
};

Result<std::vector<Index>> joined(const Surface& surface, const Topology& topology, const std::string& name,
                                  const VertexSource& source) {
  const std::vector<Index>& list = source.vertex;
  Joiner joiner(surface, topology, name, list);
  for (std::size_t i = 1; i < list.size(); ++i) {
    if (Fault fault = joiner.join(list[i - 1], list[i])) return fail(*std::move(fault));
  }
  if (!source.closed) return joiner.take_chain();
  if (Fault fault = joiner.join(list.back(), list.front())) return fail(*std::move(fault));
  std::vector<Index> chain = joiner.take_chain();
  chain.pop_back();
  return chain;
}

std::vector<Index> vertices_of_loop(const Surface& surface, const Topology& topology, Index loop) {
  std::vector<Index> chain;
  for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(loop)))
    chain.push_back(surface.corner_vertex[c]);
  return chain;
}

}  // namespace

Result<std::vector<Index>> chain_of_vertices(const Surface& surface, const Topology& topology,
                                             const std::string& name, const VertexSource& source) {
  if (Fault fault = fault_of_list(surface, topology, name, source)) return fail(*std::move(fault));
  if (source.shortest) return joined(surface, topology, name, source);
  return source.vertex;
}

Result<std::vector<Index>> chain_of_loop(const Surface& surface, const Topology& topology,
                                         const std::string& name, const LoopSource& source) {
  const Index count = topology.num_loops();
  if (source.loop >= 0 && source.loop < count) return vertices_of_loop(surface, topology, source.loop);
  std::string what = "names boundary loop " + std::to_string(source.loop) + ", but the surface has ";
  what += count == 0   ? "no boundary"
          : count == 1 ? "one loop only, number 0"
                       : std::to_string(count) + " loops, 0 to " + std::to_string(count - 1);
  return fail(feature_error(ErrorCode::FeatureBroken, name, what));
}

Result<std::vector<Index>> chain_of_nearest_loop(const Surface& surface, const Topology& topology,
                                                 const std::string& name, const BoundaryNearSource& source) {
  if (!is_finite_point(source.point))
    return fail(broken(name, "a coordinate of \"boundary_near\" is not a finite number"));
  if (topology.num_loops() == 0) return fail(broken(name, "the surface has no boundary"));
  Index nearest = 0;
  double least = kInfinity;
  for (Index l = 0; l < topology.num_loops(); ++l) {
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(l))) {
      const double d = squared_distance_to_segment(source.point, surface.position[surface.corner_vertex[c]],
                                                   surface.position[surface.corner_vertex[next_corner(c)]]);
      if (d < least) least = d, nearest = l;
    }
  }
  return vertices_of_loop(surface, topology, nearest);
}

}  // namespace planish
