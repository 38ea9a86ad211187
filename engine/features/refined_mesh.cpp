#include "engine/features/refined_mesh.hpp"

#include <algorithm>
#include <array>

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
  constexpr int kMostSteps = 64;  // a walk in a triangulation that is not Delaunay may go round in circles
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
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const Index t = reached[k];
    bool outside = false;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      if (on_input_edge(c)) continue;
      outside |=
          orient2(local(vertex(c), input_triangle), local(vertex(next_corner(c)), input_triangle), at) < 0;
      const Index next = corner_twin_[c] / 3;
      if (std::find(reached.begin(), reached.end(), next) == reached.end()) reached.push_back(next);
    }
    if (!outside) return t;
  }
  return input_triangle;
}

Index RefinedMesh::insert(const SurfacePoint& point, double share, bool& snapped) {
  const Index input = point.triangle;
  const Vec2 at{point.barycentric.y, point.barycentric.z};
  const Index t = locate(input, at);
  const double tolerance = this->tolerance(input, share);
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
    if (v != kNone) return v;
  }
  snapped = foot[side].distance > 0;
  const Index v = inside_unit(foot[side].along)
                      ? try_split_edge(3 * t + static_cast<Index>(side), foot[side].along)
                      : kNone;
  return v == kNone ? nearest_vertex : v;
}

Index RefinedMesh::split_edge(Index corner, double s, double share) {
  const Index p = vertex(corner), q = vertex(next_corner(corner)), twin = corner_twin_[corner];
  double tolerance = this->tolerance(triangle_origin_[corner / 3], share);
  if (twin != kNone) tolerance = std::min(tolerance, this->tolerance(triangle_origin_[twin / 3], share));
  const double length = norm(position_[q] - position_[p]);
  const Index end = s < 0.5 ? p : q;
  if (std::min(s, 1 - s) * length <= tolerance) return end;
  const Index v = try_split_edge(corner, s);
  return v == kNone ? end : v;
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
  const auto split = middle_.find(edge_key(u, v));
  if (split == middle_.end()) {
    chain.push_back(v);
    return;
  }
  follow(u, split->second, chain);
  follow(split->second, v, chain);
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
    if (!try_flip(c)) continue;
    for (const Index edge : {c, previous_corner(c), twin, previous_corner(twin)}) waiting.push_back(edge);
  }
  changed_.clear();
}

/// Flips an edge whose opposite angles sum to more than pi, by a margin against rounding.
bool RefinedMesh::try_flip(Index corner) {
  constexpr double kMargin = 1e-9;
  const Index twin = corner_twin_[corner], t = triangle_origin_[corner / 3];
  const Index next = next_corner(corner), twin_next = next_corner(twin);
  const Index p = vertex(corner), q = vertex(next), left = vertex(previous_corner(corner)),
              right = vertex(previous_corner(twin));
  const Vec2 lp = local(p, t), lq = local(q, t), ll = local(left, t), lr = local(right, t);
  const RestFrame frame = this->frame(t);
  const Vec2 fp = flat(lp, frame), fq = flat(lq, frame), fl = flat(ll, frame), fr = flat(lr, frame);
  const Vec2 a = fp - fl, b = fq - fl, c = fq - fr, d = fp - fr;
  // sin(alpha + beta) < 0 for the angles at left and right
  const double sine = cross(a, b) * dot(c, d) + dot(a, b) * cross(c, d);
  if (!(sine < -kMargin * norm(a) * norm(b) * norm(c) * norm(d))) return false;
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
  return true;
}

}  // namespace planish
