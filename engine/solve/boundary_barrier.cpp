#include "engine/solve/boundary_barrier.hpp"

#include <algorithm>

namespace planish {
namespace {

constexpr double kReach = 0.2;  // of the shortest edge around a vertex
constexpr double kWeight = 1e-2;

struct Terms {
  double value = 0, slope = 0, curvature = 0;  // over the distance
};

/// (1 - y)^3 / y
Terms barrier(double distance, double reach) {
  const double y = distance / reach;
  return {kWeight * reach * reach * (1 - y) * (1 - y) * (1 - y) / y,
          kWeight * reach * (3 - 2 * y - 1 / (y * y)), kWeight * (2 / (y * y * y) - 2)};
}

double shortest_edge_around(const ArapEnergy& mesh, Index v) {
  double shortest = kInfinity;
  for (const Index c : slice(mesh.star_corner, mesh.stars.group(v))) {
    for (const Vec2 edge : edge_vectors(mesh.frame[c / 3])) shortest = std::min(shortest, norm(edge));
  }
  return shortest;
}

Box2 box_of(Vec2 a, Vec2 b) {
  Box2 box;
  box.add(a);
  box.add(b);
  return box;
}

}  // namespace

BoundaryBarrier::BoundaryBarrier(const Exec& exec, const ArapEnergy& mesh, const Topology& topology,
                                 In<Index> vertex_component)
    : exec_(exec), fixed_(mesh.fixed) {
  std::vector<double> reach(mesh.num_vertices(), 0);
  for (const Index c : topology.loop_corner) {
    const Index v = mesh.corner_vertex[c];
    tail_.push_back(v);
    head_.push_back(mesh.corner_vertex[next_corner(c)]);
    apex_.push_back(mesh.corner_vertex[previous_corner(c)]);
    component_.push_back(vertex_component[v]);
    reach_.push_back(kReach * shortest_edge_around(mesh, v));
    reach[v] = reach_.back();
  }
  for (std::size_t k = 0; k < tail_.size(); ++k)
    edge_reach_.push_back(std::min(reach[tail_[k]], reach[head_[k]]));
}

BoundaryBarrier::BoundaryBarrier(const BoundaryBarrier& whole, const ArapEnergy& part, In<Index> vertex)
    : exec_(whole.exec_), fixed_(part.fixed) {
  std::vector<std::pair<Index, Index>> place;  // of the whole's vertices in the part
  for (Index i = 0; i < static_cast<Index>(vertex.size()); ++i) place.emplace_back(vertex[i], i);
  std::sort(place.begin(), place.end());
  const auto find = [&](Index v) {
    const auto at = std::lower_bound(place.begin(), place.end(), std::pair(v, Index{0}));
    return at != place.end() && at->first == v ? at->second : kNone;
  };
  for (std::size_t k = 0; k < whole.tail_.size(); ++k) {
    const Index tail = find(whole.tail_[k]), head = find(whole.head_[k]);
    if (tail == kNone || head == kNone) continue;
    tail_.push_back(tail);
    head_.push_back(head);
    apex_.push_back(find(whole.apex_[k]));
    component_.push_back(whole.component_[k]);
    reach_.push_back(whole.reach_[k]);
    edge_reach_.push_back(whole.edge_reach_[k]);
  }
}

/// Pairs whose boxes meet, vertices ascending; visit(block, vertex, edge), blocks at the same time.
template <class Visit>
void BoundaryBarrier::visit_candidates(In<Box2> vertex_box, In<Box2> edge_box, Visit visit) const {
  const BoxTree tree(exec_, edge_box);
  exec_.for_blocks(static_cast<Index>(vertex_box.size()), kBlock, [&](Index block, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      tree.visit_meeting(vertex_box[v], 0, [&](Index leaf) {
        const Range places = tree.leaf(leaf);
        for (Index i = places.begin; i < places.end; ++i) {
          const Index e = tree.order()[i];
          const Index vertex = tail_[v];
          if (vertex == tail_[e] || vertex == head_[e] || vertex == apex_[e]) continue;
          if (fixed_[vertex] && fixed_[tail_[e]] && fixed_[head_[e]]) continue;
          if (component_[v] != component_[e]) continue;
          if (vertex_box[v].meets(edge_box[e])) visit(block, v, e);
        }
      });
    }
  });
}

std::vector<BoundaryBarrier::Pair> BoundaryBarrier::pairs_within(double reaches, In<Vec2> uv) const {
  const auto n = static_cast<Index>(tail_.size());
  std::vector<Box2> vertex_box(n), edge_box(n);
  for (Index k = 0; k < n; ++k) {
    vertex_box[k] = box_of(uv[tail_[k]], uv[tail_[k]]).grown(reaches * reach_[k]);
    edge_box[k] = box_of(uv[tail_[k]], uv[head_[k]]);
    edge_box[k] = edge_box[k].grown(1e-12 * edge_reach_[k]);  // boxes of no width meet nothing
  }
  std::vector<std::vector<Pair>> part(Exec::num_blocks(n, kBlock));
  visit_candidates(vertex_box, edge_box, [&](Index block, Index v, Index e) {
    const double reach = std::min(reach_[v], edge_reach_[e]);
    const Vec2 point = uv[tail_[v]];
    const SegmentDistance at = segment_distance(point, uv[tail_[e]], uv[head_[e]]);
    if (at.distance < reaches * reach) part[block].push_back({v, e, reach, at});
  });
  std::vector<Pair> pairs;
  for (const auto& p : part) pairs.insert(pairs.end(), p.begin(), p.end());
  return pairs;
}

double BoundaryBarrier::add_forces(In<Vec2> uv, Out<Vec2> force) const {
  double energy = 0;
  for (const Pair& pair : pairs_within(1, uv)) {
    if (!(pair.at.distance > 0)) return kInfinity;
    const Terms terms = barrier(pair.at.distance, pair.reach);
    energy += terms.value;
    const std::array<Index, 3> corner = corners(pair);
    for (int i = 0; i < 3; ++i) {
      if (!fixed_[corner[i]]) force[corner[i]] += (0.5 * terms.slope * pair.at.share[i]) * pair.at.away;
    }
  }
  return energy;
}

std::vector<HessianElement> BoundaryBarrier::hessian(In<Vec2> uv, double projection) const {
  std::vector<HessianElement> elements;
  for (const Pair& pair : pairs_within(1, uv)) {
    const Terms terms = barrier(pair.at.distance, pair.reach);
    elements.push_back(
        {corners(pair), contact_hessian(pair.at, 0.5 * terms.slope, 0.5 * terms.curvature, projection)});
  }
  return elements;
}

std::vector<std::array<Index, 3>> BoundaryBarrier::near(In<Vec2> uv) const {
  constexpr double kMargin = 3;
  std::vector<std::array<Index, 3>> triples;
  for (const Pair& pair : pairs_within(kMargin, uv)) triples.push_back(corners(pair));
  std::sort(triples.begin(), triples.end());
  return triples;
}

bool BoundaryBarrier::is_clear_way(In<Vec2> from, In<Vec2> to) const {
  std::vector<Vec2> way(from.size());
  for (std::size_t v = 0; v < way.size(); ++v) way[v] = to[v] - from[v];
  return first_contact(from, way, 1) == kInfinity;
}

double BoundaryBarrier::first_contact(In<Vec2> uv, In<Vec2> direction, double most) const {
  const auto n = static_cast<Index>(tail_.size());
  std::vector<Box2> vertex_box(n), edge_box(n);
  const auto swept = [&](Index v) { return box_of(uv[v], uv[v] + most * direction[v]); };
  for (Index k = 0; k < n; ++k) {
    vertex_box[k] = swept(tail_[k]).grown(1e-9 * reach_[k]);
    edge_box[k] = swept(tail_[k]);
    edge_box[k].add(swept(head_[k]));
    edge_box[k] = edge_box[k].grown(1e-9 * edge_reach_[k]);
  }
  std::vector<double> part(Exec::num_blocks(n, kBlock), kInfinity);
  visit_candidates(vertex_box, edge_box, [&](Index block, Index v, Index e) {
    const Index p = tail_[v], a = tail_[e], b = head_[e];
    part[block] = std::min(part[block], planish::first_contact({uv[p], uv[a], uv[b]},
                                                               {direction[p], direction[a], direction[b]}));
  });
  double first = kInfinity;
  for (const double t : part) first = std::min(first, t);
  return first <= most ? first : kInfinity;
}

}  // namespace planish
