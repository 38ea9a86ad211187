#include "engine/features/refined_mesh.hpp"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "kernels/exact/orient2.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {
namespace {

constexpr double kGrid = 0x1p53;

/// Key of an edge without direction.
std::uint64_t edge_key(Index u, Index v) {
  const auto [low, high] = std::minmax(u, v);
  return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
}

/// Distance of x from the segment a b, and the place of the nearest point along it, in [0, 1].
struct SegmentFoot {
  double distance = 0, along = 0;
};
SegmentFoot foot_on_segment(Vec2 x, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double squared = dot(d, d);
  const double along = squared > 0 ? std::clamp(dot(x - a, d) / squared, 0.0, 1.0) : 0;
  return {norm(x - (a + along * d)), along};
}

/// A point given by barycentric coordinates, in the plane of its triangle.
Vec2 flat(Vec2 local, const RestFrame& f) { return {local.x * f.x1 + local.y * f.x2, local.y * f.y2}; }

/// Of the tolerance, for places where curves cross: moved farther, one curve would be drawn along the other.
constexpr double kCrossingShare = 0.02;
/// Constrained edges in a way that are too thin to be split, each of which bends it to one of its ends.
constexpr int kMostDetours = 16;

bool inside_unit(double t) { return t > 0 && t < 1; }

}  // namespace

RefinedMesh::RefinedMesh(const Surface& origin, const Topology& topology)
    : origin_(origin),
      topology_(topology),
      position_(origin.position.begin(), origin.position.end()),
      corner_vertex_(origin.corner_vertex.begin(), origin.corner_vertex.end()),
      corner_twin_(topology.corner_twin),
      constrained_(origin.corner_vertex.size(), 0),
      triangle_origin_(origin.num_triangles()),
      vertex_corner_(origin.num_vertices(), kNone) {
  for (Index t = 0; t < origin.num_triangles(); ++t) triangle_origin_[t] = t;
  for (Index v = 0; v < origin.num_vertices(); ++v) {
    if (topology.star_begin[v] < topology.star_begin[v + 1]) {
      vertex_corner_[v] = topology.star_corner[topology.star_begin[v]];
    }
  }
}

double RefinedMesh::tolerance(Index input_triangle, double share) const {
  double shortest = kInfinity;
  for (Index c = 3 * input_triangle; c < 3 * input_triangle + 3; ++c) {
    const Vec3 edge =
        origin_.position[origin_.corner_vertex[next_corner(c)]] - origin_.position[origin_.corner_vertex[c]];
    shortest = std::min(shortest, norm(edge));
  }
  return share * shortest;
}

Vec2 RefinedMesh::local(Index v, Index input_triangle) const {
  constexpr std::array<Vec2, 3> kCorner = {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}};
  if (v < num_input_vertices()) {
    Index i = 0;
    while (i < 2 && origin_.corner_vertex[3 * input_triangle + i] != v) ++i;
    return kCorner[i];
  }
  const Site& site = site_[v - num_input_vertices()];
  if (site.half_edge == kNone) return {site.a, site.b};
  const bool own = site.half_edge / 3 == input_triangle;
  const Index half_edge = own ? site.half_edge : topology_.corner_twin[site.half_edge];
  const double t = own ? site.a : 1 - site.a;
  if (half_edge % 3 == 0) return {t, 0};
  return half_edge % 3 == 1 ? Vec2{1 - t, t} : Vec2{0, 1 - t};
}

RestFrame RefinedMesh::frame(Index input_triangle) const {
  const Index* v = &origin_.corner_vertex[3 * input_triangle];
  return rest_frame(origin_.position[v[0]], origin_.position[v[1]], origin_.position[v[2]]);
}

Vec3 RefinedMesh::place(const Site& site) const {
  if (site.half_edge != kNone) {
    const Vec3 a = origin_.position[origin_.corner_vertex[site.half_edge]];
    const Vec3 b = origin_.position[origin_.corner_vertex[next_corner(site.half_edge)]];
    return a + site.a * (b - a);
  }
  const Index* v = &origin_.corner_vertex[3 * site.triangle];
  const Vec3 a = origin_.position[v[0]];
  return a + site.a * (origin_.position[v[1]] - a) + site.b * (origin_.position[v[2]] - a);
}

SurfacePoint RefinedMesh::origin(Index new_vertex) const {
  const Site& site = site_[new_vertex - num_input_vertices()];
  const Index t = site.half_edge == kNone ? site.triangle : site.half_edge / 3;
  const Vec2 at = local(new_vertex, t);
  const bool opposite =
      site.half_edge != kNone && site.half_edge % 3 == 1;  // exactly on the edge of corners 1, 2
  return {t, {opposite ? 0 : 1 - at.x - at.y, at.x, at.y}};
}

bool RefinedMesh::on_input_edge(Index corner) const {
  const Index twin = corner_twin_[corner];
  return twin == kNone || triangle_origin_[twin / 3] != triangle_origin_[corner / 3];
}

Index RefinedMesh::edge_between(Index u, Index v) const {
  Index found = kNone;
  visit_star(u, [&](Index c) {
    if (vertex(next_corner(c)) == v) {
      found = c;
    } else if (vertex(previous_corner(c)) == v) {
      found = previous_corner(c);
    }
    return found != kNone;
  });
  return found;
}

// ---- places ---------------------------------------------------------------------------------------------------

/// The piece of an input triangle that contains a point: a walk towards it over the edges that have it outside.
Index RefinedMesh::locate(Index input_triangle, Vec2 at) const {
  constexpr int kMostSteps = 1000;  // across constrained edges a walk may go round in circles
  Index t = input_triangle;
  for (int step = 0; step < kMostSteps; ++step) {
    Index next = kNone;
    for (Index i = 0; i < 3 && next == kNone; ++i) {
      const Index c = 3 * t + (i + step) % 3;
      if (on_input_edge(c)) continue;  // beyond it by rounding only
      if (orient2(local(vertex(c), input_triangle), local(vertex(next_corner(c)), input_triangle), at) < 0) {
        next = corner_twin_[c] / 3;
      }
    }
    if (next == kNone) return t;
    t = next;
  }
  return locate_by_search(input_triangle, at);
}

Index RefinedMesh::locate_by_search(Index input_triangle, Vec2 at) const {
  std::vector<Index> reached = {input_triangle};
  std::unordered_set<Index> seen = {input_triangle};
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const Index t = reached[k];
    bool outside = false;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      if (on_input_edge(c)) continue;
      outside |=
          orient2(local(vertex(c), input_triangle), local(vertex(next_corner(c)), input_triangle), at) < 0;
      const Index next = corner_twin_[c] / 3;
      if (seen.insert(next).second) reached.push_back(next);
    }
    if (!outside) return t;
  }
  return input_triangle;
}

Index RefinedMesh::insert(const SurfacePoint& point, double tolerance, bool& snapped) {
  const Index input = point.triangle;
  const Vec2 at{point.barycentric.y, point.barycentric.z};
  const Index t = locate(input, at);
  const RestFrame frame = this->frame(input);
  const Vec2 x = flat(at, frame);
  std::array<Vec2, 3> corner;
  std::array<double, 3> distance;
  for (Index i = 0; i < 3; ++i) {
    corner[i] = flat(local(vertex(3 * t + i), input), frame);
    distance[i] = norm(x - corner[i]);
  }
  const auto nearest = std::min_element(distance.begin(), distance.end()) - distance.begin();
  const Index nearest_vertex = vertex(3 * t + static_cast<Index>(nearest));
  snapped = true;
  if (distance[nearest] <= tolerance) {
    snapped = distance[nearest] > 0;
    return nearest_vertex;
  }
  std::array<SegmentFoot, 3> foot;
  for (Index i = 0; i < 3; ++i) foot[i] = foot_on_segment(x, corner[i], corner[(i + 1) % 3]);
  const auto side =
      std::min_element(foot.begin(), foot.end(),
                       [](const SegmentFoot& a, const SegmentFoot& b) { return a.distance < b.distance; }) -
      foot.begin();
  if (foot[side].distance > tolerance) {
    const Index v = try_split_triangle(t, at);
    snapped = v == kNone;
    if (v != kNone) {
      improve();
      return v;
    }
  }
  snapped = foot[side].distance > 0;
  const Index v = inside_unit(foot[side].along)
                      ? try_split_edge(3 * t + static_cast<Index>(side), foot[side].along)
                      : kNone;
  improve();
  return v == kNone ? nearest_vertex : v;
}

double RefinedMesh::edge_tolerance(Index corner, double share) const {
  const double own = tolerance(triangle_origin_[corner / 3], share);
  const Index twin = corner_twin_[corner];
  return twin == kNone ? own : std::min(own, tolerance(triangle_origin_[twin / 3], share));
}

Index RefinedMesh::near_end(Index corner, double s, double tolerance) const {
  const Index p = vertex(corner), q = vertex(next_corner(corner));
  const double length = norm(position_[q] - position_[p]);
  return std::min(s, 1 - s) * length <= tolerance ? (s < 0.5 ? p : q) : kNone;
}

Index RefinedMesh::split_edge(Index corner, double s, double tolerance) {
  const Index end = near_end(corner, s, tolerance);
  if (end != kNone) return end;
  const Index nearer = s < 0.5 ? vertex(corner) : vertex(next_corner(corner));
  const Index v = try_split_edge(corner, s);
  return v == kNone ? nearer : v;
}

// ---- splits ---------------------------------------------------------------------------------------------------

bool RefinedMesh::site_on_input_edge(Index corner, double s, Site& site) const {
  const Index t = triangle_origin_[corner / 3];
  const Vec2 p = local(vertex(corner), t), q = local(vertex(next_corner(corner)), t);
  double from = p.x, to = q.x;  // along corner 0 -> 1
  Index side = 0;
  if (p.x == 0 && q.x == 0) {
    from = 1 - p.y, to = 1 - q.y, side = 2;
  } else if (p.y != 0 || q.y != 0) {
    from = p.y, to = q.y, side = 1;
  }
  const double along = std::nearbyint((from + s * (to - from)) * kGrid) / kGrid;
  site = {.half_edge = 3 * t + side, .triangle = kNone, .a = along, .b = 0};
  return std::min(from, to) < along && along < std::max(from, to);
}

bool RefinedMesh::site_inside(Index corner, double s, Site& site) const {
  const Index t = triangle_origin_[corner / 3], twin = corner_twin_[corner];
  const Vec2 p = local(vertex(corner), t), q = local(vertex(next_corner(corner)), t),
             left = local(vertex(previous_corner(corner)), t),
             right = local(vertex(previous_corner(twin)), t);
  const Vec2 x = p + s * (q - p);
  site = {.half_edge = kNone, .triangle = t, .a = x.x, .b = x.y};
  return orient2(p, x, left) > 0 && orient2(x, q, left) > 0 && orient2(x, p, right) > 0 &&
         orient2(q, x, right) > 0;
}

Index RefinedMesh::try_split_edge(Index corner, double s) {
  Site site;
  const bool possible =
      on_input_edge(corner) ? site_on_input_edge(corner, s, site) : site_inside(corner, s, site);
  return possible ? connect_on_edge(corner, site) : kNone;
}

Index RefinedMesh::add_vertex(const Site& site) {
  site_.push_back(site);
  position_.push_back(place(site));
  vertex_corner_.push_back(kNone);
  return num_vertices() - 1;
}

Index RefinedMesh::add_triangle(Index a, Index b, Index c, Index origin) {
  const Index first = static_cast<Index>(corner_vertex_.size());
  corner_vertex_.insert(corner_vertex_.end(), {a, b, c});
  corner_twin_.insert(corner_twin_.end(), 3, kNone);
  constrained_.insert(constrained_.end(), 3, 0);
  triangle_origin_.push_back(origin);
  changed_.push_back(first / 3);
  return first;
}

void RefinedMesh::join(Index corner, Index twin) {
  corner_twin_[corner] = twin;
  if (twin != kNone) corner_twin_[twin] = corner;
}

void RefinedMesh::pass_on(Index from, Index to) {
  join(to, corner_twin_[from]);
  constrained_[to] = constrained_[from];
}

/// Cuts the one or two triangles at an edge from its new vertex to the corners opposite.
Index RefinedMesh::connect_on_edge(Index corner, const Site& site) {
  const Index x = add_vertex(site);
  const Index p = vertex(corner), next = next_corner(corner), q = vertex(next),
              left = vertex(previous_corner(corner));
  const Index twin = corner_twin_[corner];
  const std::uint8_t constrained = constrained_[corner];
  if (constrained) middle_[edge_key(p, q)] = x;
  changed_.push_back(corner / 3);

  const Index beyond = add_triangle(x, q, left, triangle_origin_[corner / 3]);  // p x left stays
  pass_on(next, beyond + 1);
  corner_vertex_[next] = x;
  constrained_[next] = 0;
  join(next, beyond + 2);
  constrained_[beyond] = constrained;
  vertex_corner_[x] = beyond;
  vertex_corner_[q] = beyond + 1;
  if (twin == kNone) return x;

  changed_.push_back(twin / 3);
  const Index before = previous_corner(twin), right = vertex(before);
  const Index other = add_triangle(q, x, right, triangle_origin_[twin / 3]);  // x p right stays
  pass_on(before, other + 2);
  corner_vertex_[twin] = x;
  constrained_[before] = 0;
  join(before, other + 1);
  join(beyond, other);
  constrained_[other] = constrained;
  return x;
}

Index RefinedMesh::try_split_triangle(Index t, Vec2 at) {
  const Index origin = triangle_origin_[t], c = 3 * t;
  const Index p = vertex(c), q = vertex(c + 1), r = vertex(c + 2);
  const Vec2 a = local(p, origin), b = local(q, origin), d = local(r, origin);
  if (orient2(a, b, at) <= 0 || orient2(b, d, at) <= 0 || orient2(d, a, at) <= 0) return kNone;
  const Index x = add_vertex({.half_edge = kNone, .triangle = origin, .a = at.x, .b = at.y});
  changed_.push_back(t);
  const Index second = add_triangle(q, r, x, origin), third = add_triangle(r, p, x, origin);  // p q x stays
  pass_on(c + 1, second);
  pass_on(c + 2, third);
  corner_vertex_[c + 2] = x;
  constrained_[c + 1] = constrained_[c + 2] = 0;
  join(c + 1, second + 2);
  join(second + 1, third + 2);
  join(third + 1, c + 2);
  vertex_corner_[x] = c + 2;
  vertex_corner_[r] = third;
  return x;
}

// ---- constrained edges ----------------------------------------------------------------------------------------

void RefinedMesh::constrain(Index corner) {
  constrained_[corner] = 1;
  if (corner_twin_[corner] != kNone) constrained_[corner_twin_[corner]] = 1;
}

void RefinedMesh::follow(Index u, Index v, std::vector<Index>& chain) const {
  std::vector<Index> ahead = {v};
  while (!ahead.empty()) {
    const auto split = middle_.find(edge_key(u, ahead.back()));
    if (split != middle_.end()) {
      ahead.push_back(split->second);
    } else {
      u = ahead.back();
      chain.push_back(u);
      ahead.pop_back();
    }
  }
}

/// An input triangle that holds both vertices, or kNone. On a common edge of two it does not matter which.
Index RefinedMesh::common_input_triangle(Index u, Index v) const {
  Index common = kNone;
  visit_star(u, [&](Index a) {
    const Index origin = triangle_origin_[a / 3];
    return visit_star(v, [&](Index b) {
      if (triangle_origin_[b / 3] == origin) common = origin;
      return common != kNone;
    });
  });
  return common;
}

bool RefinedMesh::connect(Index u, Index v, double share, std::vector<Index>& chain) {
  while (u != v) {
    const Index input = common_input_triangle(u, v);
    if (input == kNone) return false;
    const Index next = step_towards(u, v, input, share, kMostDetours);
    if (next == kNone) return false;
    constrain(edge_between(u, next));
    chain.push_back(next);
    u = next;
  }
  improve();
  return true;
}

/// Makes an edge from a vertex to the first one on the straight way to another, or to a new one on the first
/// constrained edge in the way, and returns that vertex. kNone: nothing leads on, which no sound state allows.
Index RefinedMesh::step_towards(Index from, Index to, Index input_triangle, double share, int detours) {
  const Vec2 a = local(from, input_triangle), b = local(to, input_triangle);
  const auto side = [&](Index v) { return orient2(a, b, local(v, input_triangle)); };
  Index found = kNone, corner = kNone;
  visit_star(from, [&](Index c) {
    if (triangle_origin_[c / 3] != input_triangle) return false;
    const Index opposite = next_corner(c);
    for (const Index v : {vertex(opposite), vertex(next_corner(opposite))}) {
      const bool ahead = dot(local(v, input_triangle) - a, b - a) > 0;
      if (v == to || (found == kNone && ahead && side(v) == 0)) found = v;
    }
    if (side(vertex(opposite)) < 0 && side(vertex(next_corner(opposite))) > 0) corner = opposite;
    return found == to;
  });
  if (found != kNone) return found;
  std::vector<Index> crossed;
  while (corner != kNone) {
    if (constrained_[corner] || on_input_edge(corner)) {
      const Index on_edge = split_in_way(corner, a, b, input_triangle, share);
      return on_edge == to || detours == 0 ? kNone
                                           : step_towards(from, on_edge, input_triangle, share, detours - 1);
    }
    crossed.push_back(vertex(corner));
    crossed.push_back(vertex(next_corner(corner)));
    const Index twin = corner_twin_[corner], apex = vertex(previous_corner(twin));
    const int apex_side = side(apex);
    if (apex_side == 0) {
      clear_way(from, apex, crossed, input_triangle);
      return edge_between(from, apex) == kNone ? kNone : apex;
    }
    // twin runs from the left to the right end; the next half-edge crossed has its tail on the right.
    corner = apex_side > 0 ? next_corner(twin) : previous_corner(twin);
  }
  return kNone;
}

/// Splits an edge where the way crosses it, or takes its end within tolerance or where no split is possible.
Index RefinedMesh::split_in_way(Index corner, Vec2 from, Vec2 to, Index input_triangle, double share) {
  const Vec2 p = local(vertex(corner), input_triangle),
             q = local(vertex(next_corner(corner)), input_triangle);
  const double before = cross(to - from, p - from), behind = cross(to - from, q - from);
  const double s = before == behind ? 0.5 : std::clamp(before / (before - behind), 0.0, 1.0);
  return split_edge(corner, s, edge_tolerance(corner, kCrossingShare * share));
}

/// Flips the edges between `from` and `to`, given by their ends, until none is in the way.
void RefinedMesh::clear_way(Index from, Index to, std::vector<Index> crossed, Index input_triangle) {
  const Vec2 a = local(from, input_triangle), b = local(to, input_triangle);
  std::size_t idle = 0;  // edges put back since the last flip
  for (std::size_t k = 0; k + 1 < crossed.size() && 2 * idle <= crossed.size() - k; k += 2) {
    const Index p = crossed[k], q = crossed[k + 1], corner = edge_between(p, q);
    if (corner == kNone || p == to || q == to || p == from || q == from) continue;
    const int side_p = orient2(a, b, local(p, input_triangle)),
              side_q = orient2(a, b, local(q, input_triangle));
    if (side_p * side_q >= 0 || constrained_[corner] || on_input_edge(corner)) continue;
    const Index left = vertex(previous_corner(corner)), right = vertex(previous_corner(corner_twin_[corner]));
    if (!flip(corner)) {
      crossed.push_back(p), crossed.push_back(q);
      ++idle;
      continue;
    }
    idle = 0;
    if (orient2(a, b, local(left, input_triangle)) * orient2(a, b, local(right, input_triangle)) < 0) {
      crossed.push_back(left), crossed.push_back(right);
    }
  }
}

void RefinedMesh::improve() {
  std::vector<Index> waiting;
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  for (const Index t : changed_) waiting.insert(waiting.end(), {3 * t, 3 * t + 1, 3 * t + 2});
  while (!waiting.empty()) {
    const Index c = waiting.back();
    waiting.pop_back();
    if (constrained_[c] || on_input_edge(c)) continue;
    const Index twin = corner_twin_[c];
    if (!wants_flip(c) || !flip(c)) continue;
    for (const Index edge : {c, previous_corner(c), twin, previous_corner(twin)}) waiting.push_back(edge);
  }
  changed_.clear();
}

/// The angles opposite the edge sum to more than pi, by a margin against rounding.
bool RefinedMesh::wants_flip(Index corner) const {
  constexpr double kMargin = 1e-9;
  const Index t = triangle_origin_[corner / 3];
  const RestFrame frame = this->frame(t);
  const auto at = [&](Index c) { return flat(local(vertex(c), t), frame); };
  const Vec2 p = at(corner), q = at(next_corner(corner)), left = at(previous_corner(corner)),
             right = at(previous_corner(corner_twin_[corner]));
  const Vec2 a = p - left, b = q - left, c = q - right, d = p - right;
  const double sine = cross(a, b) * dot(c, d) + dot(a, b) * cross(c, d);  // of the sum
  return sine < -kMargin * norm(a) * norm(b) * norm(c) * norm(d);
}

/// Replaces an edge inside an input triangle by the other diagonal of its two triangles, where both pieces have
/// positive area; false where not.
bool RefinedMesh::flip(Index corner) {
  const Index twin = corner_twin_[corner], t = triangle_origin_[corner / 3];
  const Index next = next_corner(corner), twin_next = next_corner(twin);
  const Index p = vertex(corner), q = vertex(next), left = vertex(previous_corner(corner)),
              right = vertex(previous_corner(twin));
  const Vec2 lp = local(p, t), lq = local(q, t), ll = local(left, t), lr = local(right, t);
  if (orient2(lp, lr, ll) <= 0 || orient2(lq, ll, lr) <= 0) return false;
  // p right left and q left right; the outer half-edges keep their constraints.
  pass_on(twin_next, corner);
  pass_on(next, twin);
  corner_vertex_[next] = right;
  corner_vertex_[twin_next] = left;
  constrained_[next] = constrained_[twin_next] = 0;
  join(next, twin_next);
  vertex_corner_[p] = corner;
  vertex_corner_[q] = twin;
  changed_.push_back(corner / 3);
  changed_.push_back(twin / 3);
  return true;
}

}  // namespace planish
