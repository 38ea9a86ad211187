#include "engine/features/trace.hpp"

#include <algorithm>
#include <queue>
#include <unordered_map>

namespace planish {
namespace {

constexpr double kMostDetour = 3;  // of the segment's length: paths longer than that went round something

/// Length walked so far, and whether the path may go on.
class Odometer {
 public:
  Odometer(const Chord& chord, Vec3 start)
      : chord_(chord), at_(start), most_(kMostDetour * norm(chord.to - chord.from) + 4 * chord.allowed) {}

  bool pass(Vec3 point) {
    length_ += norm(point - at_);
    at_ = point;
    return length_ <= most_ && distance_to(chord_, point) <= chord_.allowed;
  }

 private:
  const Chord& chord_;
  Vec3 at_;
  double length_ = 0, most_;
};

/// The walk of a plane over a mesh. A vertex on the plane counts as on its positive side, so that every edge either
/// is crossed or is not; a crossing may then lie at an end of its edge.
class PlaneWalk {
 public:
  PlaneWalk(const RefinedMesh& mesh, Index from, Index to, Vec3 normal, const Chord& chord)
      : mesh_(mesh),
        from_(from),
        to_(to),
        origin_(mesh.position(from)),
        ahead_(mesh.position(to) - origin_),
        across_(cross(ahead_, normal)),
        odometer_(chord, origin_) {}

  std::optional<SurfacePath> operator()() {
    Index corner = leave();
    if (arrived_) return SurfacePath{};
    while (corner != kNone) {
      const Index tail = mesh_.vertex(corner), head = mesh_.vertex(next_corner(corner));
      if (tail == to_ || head == to_) return std::move(path_);
      const double s = crossing(tail, head);
      if (!odometer_.pass(point(tail, head, s))) return std::nullopt;
      path_.push_back({tail, head, s});
      corner = next(corner);
      if (arrived_) return std::move(path_);
    }
    return std::nullopt;
  }

 private:
  double side(Index v) const {
    return v == from_ || v == to_ ? 0 : dot(mesh_.position(v) - origin_, across_);
  }
  bool crosses(Index tail, Index head) const { return (side(tail) >= 0) != (side(head) >= 0); }
  double crossing(Index tail, Index head) const {
    const double a = side(tail), b = side(head);
    return std::clamp(a / (a - b), 0.0, 1.0);
  }
  Vec3 point(Index tail, Index head, double s) const {
    return mesh_.position(tail) + s * (mesh_.position(head) - mesh_.position(tail));
  }

  /// The half-edge opposite the start that the plane crosses most directly ahead.
  Index leave() {
    Index best = kNone;
    double best_cosine = 0;
    mesh_.visit_star(from_, [&](Index c) {
      const Index opposite = next_corner(c), tail = mesh_.vertex(opposite),
                  head = mesh_.vertex(previous_corner(c));
      arrived_ = tail == to_ || head == to_;
      if (arrived_ || !crosses(tail, head)) return arrived_;
      const Vec3 way = point(tail, head, crossing(tail, head)) - origin_;
      const double length = norm(way), cosine = length > 0 ? dot(way, ahead_) / length : 0;
      if (cosine > best_cosine) {
        best = opposite;
        best_cosine = cosine;
      }
      return false;
    });
    return best;
  }

  /// The half-edge by which the plane leaves the triangle beyond one.
  Index next(Index corner) {
    const Index twin = mesh_.twin(corner);
    if (twin == kNone) return kNone;
    const Index apex = mesh_.vertex(previous_corner(twin));
    arrived_ = apex == to_;
    return crosses(mesh_.vertex(next_corner(twin)), apex) ? next_corner(twin) : previous_corner(twin);
  }

  const RefinedMesh& mesh_;
  Index from_, to_;
  Vec3 origin_, ahead_, across_;
  Odometer odometer_;
  SurfacePath path_;
  bool arrived_ = false;
};

/// Half-edges crossed from a triangle at `from` to one at `to`, found best first by the length through midpoints.
class StripSearch {
 public:
  StripSearch(const RefinedMesh& mesh, Index from, Index to, const Chord& chord)
      : mesh_(mesh), from_(from), to_(to), chord_(chord) {}

  /// None: no strip. The strip may be empty where both vertices share a triangle.
  std::optional<std::vector<Index>> operator()() {
    mesh_.visit_star(from_, [&](Index c) {
      reach(c / 3, kNone, 0, mesh_.position(from_));
      return false;
    });
    while (!waiting_.empty()) {
      const Entry entry = waiting_.top();
      waiting_.pop();
      Reached& reached = reached_.at(entry.triangle);
      if (reached.done) continue;
      reached.done = true;
      for (Index c = 3 * entry.triangle; c < 3 * entry.triangle + 3; ++c) {
        if (mesh_.vertex(c) == to_) return strip_to(entry.triangle);
      }
      const Vec3 at = reached.at;
      const double length = reached.length;
      for (Index c = 3 * entry.triangle; c < 3 * entry.triangle + 3; ++c) cross_edge(c, length, at);
    }
    return std::nullopt;
  }

 private:
  struct Reached {
    double length = kInfinity;
    Vec3 at;
    Index by = kNone;  // half-edge crossed to come here
    bool done = false;
  };
  struct Entry {
    double bound;
    Index triangle;
    bool operator>(const Entry& other) const {
      return bound != other.bound ? bound > other.bound : triangle > other.triangle;
    }
  };

  void cross_edge(Index c, double length, Vec3 at) {
    const Index twin = mesh_.twin(c);
    if (twin == kNone) return;
    const Vec3 a = mesh_.position(mesh_.vertex(c)), b = mesh_.position(mesh_.vertex(next_corner(c)));
    if (!near_chord(a, b)) return;
    const Vec3 middle = 0.5 * (a + b);
    reach(twin / 3, c, length + norm(middle - at), middle);
  }

  /// Whether some point of the edge is near enough to the segment: sampled, since only the search is steered by it.
  bool near_chord(Vec3 a, Vec3 b) const {
    constexpr int kSamples = 8;
    for (int i = 0; i <= kSamples; ++i) {
      if (distance_to(chord_, a + (static_cast<double>(i) / kSamples) * (b - a)) <= chord_.allowed)
        return true;
    }
    return false;
  }

  void reach(Index triangle, Index by, double length, Vec3 at) {
    Reached& reached = reached_[triangle];
    if (reached.done || length >= reached.length) return;
    reached = {length, at, by, false};
    waiting_.push({length + norm(chord_.to - at), triangle});
  }

  std::vector<Index> strip_to(Index triangle) const {
    std::vector<Index> strip;
    for (Index by = reached_.at(triangle).by; by != kNone; by = reached_.at(by / 3).by) strip.push_back(by);
    std::reverse(strip.begin(), strip.end());
    return strip;
  }

  const RefinedMesh& mesh_;
  Index from_, to_;
  const Chord& chord_;
  std::unordered_map<Index, Reached> reached_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting_;
};

/// A strip of triangles laid into the plane: its portals (edges crossed) and its two ends.
struct FlatStrip {
  std::vector<Vec2> left, right;  // of the portals, seen along the strip
  std::vector<Index> left_vertex, right_vertex;
  Vec2 from, to;
};

/// Third corner of a triangle over the base a b, on its left, by the lengths in space.
Vec2 lay_out(Vec2 a, Vec2 b, Vec3 pa, Vec3 pb, Vec3 apex) {
  const Vec3 base = pb - pa;
  const double length = norm(base);
  const Vec2 along = (1 / length) * (b - a);
  const double x = dot(apex - pa, base) / length, y = norm(cross(base, apex - pa)) / length;
  return a + x * along + y * Vec2{-along.y, along.x};
}

/// Pre: strip not empty. Portal k is the half-edge strip[k], whose tail is on the right of the way and whose head is
/// on the left.
FlatStrip lay_out(const RefinedMesh& mesh, In<Index> strip, Index from) {
  FlatStrip flat;
  const auto at = [&](Index v) { return mesh.position(v); };
  const Index first_tail = mesh.vertex(strip[0]), first_head = mesh.vertex(next_corner(strip[0]));
  Vec2 tail{0, 0}, head{norm(at(first_head) - at(first_tail)), 0};
  // The triangle behind the first portal lies on the left of tail -> head; the strip goes on to the right.
  flat.from = lay_out(tail, head, at(first_tail), at(first_head), at(from));
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const Index vt = mesh.vertex(strip[k]), vh = mesh.vertex(next_corner(strip[k]));
    flat.right.push_back(tail), flat.right_vertex.push_back(vt);
    flat.left.push_back(head), flat.left_vertex.push_back(vh);
    const Index twin = mesh.twin(strip[k]), apex = mesh.vertex(previous_corner(twin));
    const Vec2 beyond = lay_out(head, tail, at(vh), at(vt), at(apex));
    if (k + 1 == strip.size()) {
      flat.to = beyond;
    } else if (mesh.vertex(strip[k + 1]) == vt) {
      head = beyond;  // tail -> apex
    } else {
      tail = beyond;  // apex -> head
    }
  }
  return flat;
}

/// Corners of the shortest path: portal numbers and whether on the left; ends left out.
struct Turn {
  std::size_t portal;
  bool left;
};

/// Funnel over the portals; the last portal is followed by the end point.
std::vector<Turn> funnel(const FlatStrip& flat) {
  std::vector<Turn> turns;
  const std::size_t n = flat.left.size();
  const auto left = [&](std::size_t k) { return k < n ? flat.left[k] : flat.to; };
  const auto right = [&](std::size_t k) { return k < n ? flat.right[k] : flat.to; };
  Vec2 apex = flat.from;
  std::size_t at_left = 0, at_right = 0;
  const auto restart = [&](std::size_t portal, bool on_left) {
    turns.push_back({portal, on_left});
    apex = on_left ? left(portal) : right(portal);
    at_left = at_right = std::min(portal + 1, n);
    return at_left;
  };
  for (std::size_t k = 1; k <= n; ++k) {
    // The triangle (apex, right, left) turns counter-clockwise while the funnel is open.
    if (cross(right(at_right) - apex, right(k) - apex) >= 0) {
      if (right(at_right) == apex || left(at_left) == apex ||
          cross(left(at_left) - apex, right(k) - apex) < 0) {
        at_right = k;
      } else if (at_left < n) {
        k = restart(at_left, true);
        continue;
      }
    }
    if (cross(left(at_left) - apex, left(k) - apex) <= 0) {
      if (left(at_left) == apex || right(at_right) == apex ||
          cross(right(at_right) - apex, left(k) - apex) > 0) {
        at_left = k;
      } else if (at_right < n) {
        k = restart(at_right, false);
      }
    }
  }
  return turns;
}

}  // namespace

double distance_to(const Chord& chord, Vec3 point) {
  const Vec3 d = chord.to - chord.from;
  const double squared = dot(d, d);
  const double along = squared > 0 ? std::clamp(dot(point - chord.from, d) / squared, 0.0, 1.0) : 0;
  return norm(point - (chord.from + along * d));
}

std::optional<SurfacePath> path_in_plane(const RefinedMesh& mesh, Index from, Index to, Vec3 normal,
                                         const Chord& chord) {
  return PlaneWalk(mesh, from, to, normal, chord)();
}

std::optional<SurfacePath> path_in_strip(const RefinedMesh& mesh, Index from, Index to, const Chord& chord) {
  const auto strip = StripSearch(mesh, from, to, chord)();
  if (!strip || strip->empty()) return strip ? std::optional(SurfacePath{}) : std::nullopt;
  const FlatStrip flat = lay_out(mesh, *strip, from);
  std::vector<Turn> turns = funnel(flat);
  turns.push_back({flat.left.size(), false});  // the end

  SurfacePath path;
  Odometer odometer(chord, mesh.position(from));
  Vec2 start = flat.from;
  std::size_t portal = 0;
  for (const Turn& turn : turns) {
    const bool last = turn.portal == flat.left.size();
    const Vec2 end = last ? flat.to : (turn.left ? flat.left : flat.right)[turn.portal];
    const Index corner_vertex =
        last ? kNone : (turn.left ? flat.left_vertex : flat.right_vertex)[turn.portal];
    for (; portal < turn.portal + (last ? 0 : 1); ++portal) {
      const Index tail = flat.right_vertex[portal], head = flat.left_vertex[portal];
      if (tail == corner_vertex || head == corner_vertex) continue;
      const double a = cross(end - start, flat.right[portal] - start),
                   b = cross(end - start, flat.left[portal] - start);
      const double s = a == b ? 0.5 : std::clamp(a / (a - b), 0.0, 1.0);
      path.push_back({tail, head, s});
      if (!odometer.pass(mesh.position(tail) + s * (mesh.position(head) - mesh.position(tail))))
        return std::nullopt;
    }
    start = end;
    if (corner_vertex == kNone) continue;
    path.push_back({corner_vertex, kNone, 0});
    if (!odometer.pass(mesh.position(corner_vertex))) return std::nullopt;
  }
  return path;
}

}  // namespace planish
