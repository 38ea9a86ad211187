#include "engine/features/sheet_search.hpp"

#include <algorithm>
#include <functional>

namespace planish {
namespace {

double squared_norm(Vec3 a) { return dot(a, a); }

/// Squared distance of two segments.
/// Ref: Ericson, Real-Time Collision Detection, 2005, 5.1.9.
double squared_distance(const Segment& a, const Segment& b) {
  const Vec3 u = a.end - a.begin, v = b.end - b.begin, w = a.begin - b.begin;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const double determinant = uu * vv - uv * uv;
  const auto ratio = [](double x, double y) { return y > 0 ? std::clamp(x / y, 0.0, 1.0) : 0.0; };
  double s = ratio(uv * vw - uw * vv, determinant);
  const double t = ratio(uv * s + vw, vv);
  s = ratio(uv * t - uw, uu);  // exact where t was clamped, no change elsewhere
  return squared_norm(w + s * u - t * v);
}

}  // namespace

bool Capsule::meets(const Segment& edge) const { return squared_distance(axis, edge) <= radius * radius; }

bool SheetSearch::joined(const Hit& a, const Hit& b, const Capsule& capsule) {
  return a.at.triangle == b.at.triangle || walks(a, b, capsule) || explore(a, b, capsule);
}

SheetSearch::Hit SheetSearch::closest_reached(Vec3 query) const {
  Hit best;
  for (const Index t : reached_.members()) {
    const Hit hit = closest_point(surface_, t, query);
    if (hit.distance < best.distance || (hit.distance == best.distance && t < best.at.triangle)) best = hit;
  }
  return best;
}

Vec3 SheetSearch::normal(Index t) const {
  const Vec3 n = cross(corner(3 * t + 1) - corner(3 * t), corner(3 * t + 2) - corner(3 * t));
  const double length = norm(n);
  return length > 0 ? (1 / length) * n : n;
}

/// The vertex of a corner is also one of triangle t, and in the capsule: its fan joins the two.
bool SheetSearch::is_common(Index corner, Index t, const Capsule& capsule) const {
  const Index v = surface_.corner_vertex[corner];
  for (Index i = 3 * t; i < 3 * t + 3; ++i) {
    if (v == surface_.corner_vertex[i]) return topology_.single_fan[v] && capsule.contains(this->corner(i));
  }
  return false;
}

/// Walks from a straight towards b, in the plane of their chord and the mean normal. True proves that they
/// are joined, false proves nothing; most segments need no more than this.
bool SheetSearch::walks(const Hit& a, const Hit& b, const Capsule& capsule) const {
  const Vec3 chord = b.position - a.position;
  const Vec3 across = cross(chord, normal(a.at.triangle) + normal(b.at.triangle));
  const auto side = [&](Vec3 p) { return dot(p - a.position, across) >= 0; };
  Index t = a.at.triangle, entry = kNone;
  for (Index c = 3 * t; c < 3 * t + 3; ++c) {
    if (is_common(c, b.at.triangle, capsule)) return true;
  }
  double reached = -kInfinity;
  const double end = squared_norm(chord) + capsule.radius * norm(chord);
  while (true) {
    Index exit = kNone;
    double along = reached;
    Vec3 place;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      if (c == entry || side(corner(c)) == side(corner(next_corner(c)))) continue;
      const Vec3 at = crossing(c, a.position, across);
      const double ahead = dot(at - a.position, chord);
      if (ahead > along) exit = c, along = ahead, place = at;
    }
    if (exit == kNone || along > end || !capsule.contains(place)) return false;
    entry = topology_.corner_twin[exit];
    if (entry == kNone) return false;
    t = entry / 3;
    if (t == b.at.triangle || is_common(previous_corner(entry), b.at.triangle, capsule)) return true;
    reached = along;
  }
}

Vec3 SheetSearch::crossing(Index c, Vec3 origin, Vec3 across) const {
  const Segment s = edge(c);
  const double from = dot(s.begin - origin, across), to = dot(s.end - origin, across);
  return s.begin + (from / (from - to)) * (s.end - s.begin);
}

/// Best-first search from a over the edges that meet the capsule, those near b first.
bool SheetSearch::explore(const Hit& a, const Hit& b, const Capsule& capsule) {
  reached_.clear();
  open_.clear();
  reached_.insert(a.at.triangle);
  open_.push_back({0, a.at.triangle});
  while (!open_.empty()) {
    std::ranges::pop_heap(open_, std::greater{});
    const Index t = open_.back().triangle;
    open_.pop_back();
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const Index twin = topology_.corner_twin[c];
      if (twin == kNone || !capsule.meets(edge(c)) || !reached_.insert(twin / 3)) continue;
      if (twin / 3 == b.at.triangle) return true;
      open_.push_back({squared_norm(corner(previous_corner(twin)) - b.position), twin / 3});
      std::ranges::push_heap(open_, std::greater{});
    }
  }
  return false;
}

}  // namespace planish
