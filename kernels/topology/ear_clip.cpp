#include "kernels/topology/ear_clip.hpp"

#include <array>
#include <utility>

namespace planish {
namespace {

/// Twice the area vector of the polygon, about its first corner so that far-away polygons keep their digits.
Vec3 newell_normal(In<Vec3> polygon) {
  Vec3 normal;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    normal = normal + cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  return normal;
}

/// The two coordinates that show the polygon counter-clockwise and largest.
struct View {
  explicit View(Vec3 normal) {
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    double along = normal.z;
    if (x >= y && x >= z) {
      u = &Vec3::y, w = &Vec3::z, along = normal.x;
    } else if (y >= z) {
      u = &Vec3::z, w = &Vec3::x, along = normal.y;
    }
    if (along < 0) std::swap(u, w);
  }
  Vec2 operator()(const Vec3& p) const { return {p.*u, p.*w}; }
  double Vec3::*u = &Vec3::x;
  double Vec3::*w = &Vec3::y;
};

class EarClipper {
 public:
  EarClipper(In<Vec3> polygon, Out<Index> triangle, Out<Index> scratch)
      : polygon_(polygon),
        triangle_(triangle),
        n_(static_cast<Index>(polygon.size())),
        view_(newell_normal(polygon)),
        previous_(scratch.subspan(0, polygon.size())),
        next_(scratch.subspan(polygon.size(), polygon.size())),
        reflex_(scratch.subspan(2 * polygon.size(), polygon.size())),
        queue_(scratch.subspan(3 * polygon.size(), 3 * polygon.size())) {}

  void run() {
    for (Index i = 0; i < n_; ++i) {
      previous_[i] = i == 0 ? n_ - 1 : i - 1;
      next_[i] = i + 1 == n_ ? 0 : i + 1;
      queue_[i] = next_[i];  // corner 1 first, so that convex polygons become the fan of corner 0
    }
    queue_end_ = n_;
    for (Index i = 0; i < n_; ++i) {
      if (!(turn(i) > 0)) reflex_[num_reflex_++] = i;
    }
    Index left = n_;
    Index queue_begin = 0;
    for (; left > 3; --left) {
      while (queue_begin < queue_end_ && !is_ear(queue_[queue_begin])) ++queue_begin;
      cut(queue_begin < queue_end_ ? queue_[queue_begin++] : forced_ear());
    }
    Index i = 0;
    while (removed(i)) ++i;
    emit(i);
  }

 private:
  Vec2 at(Index i) const { return view_(polygon_[i]); }
  bool removed(Index i) const { return next_[i] == kNone; }

  static double orientation(Vec2 a, Vec2 b, Vec2 c) { return cross(b - a, c - a); }

  /// Positive where the boundary turns left, towards the inside.
  double turn(Index i) const { return orientation(at(previous_[i]), at(i), at(next_[i])); }

  /// A corner that bulges outwards and whose triangle holds no other corner of what is left.
  bool is_ear(Index i) const {
    if (removed(i) || !(turn(i) > 0)) return false;
    const Vec2 a = at(previous_[i]), b = at(i), c = at(next_[i]);
    for (Index k = 0; k < num_reflex_; ++k) {
      const Index j = reflex_[k];
      if (removed(j) || j == previous_[i] || j == next_[i]) continue;
      const Vec2 p = at(j);
      // Corners at the same point are the two sides of a bridge to a hole.
      if (p == a || p == b || p == c) continue;
      if (orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0) return false;
    }
    return true;
  }

  /// Where no ear is left (the polygon crosses itself, or rounding hides one): an outward corner if one is
  /// near the last one cut this way, else any. Few steps, so that hostile polygons cost no more than others.
  Index forced_ear() {
    constexpr int kSteps = 16;
    while (removed(forced_)) ++forced_;
    Index i = forced_;
    for (int step = 0; step < kSteps; ++step, i = next_[i]) {
      if (turn(i) > 0) return i;
    }
    return forced_;
  }

  /// The triangle of corner i, written from its smallest corner on, as fans are usually written.
  void emit(Index i) {
    const Index a = previous_[i], c = next_[i];
    const std::array<Index, 5> turns = {a, i, c, a, i};
    const int first = i < a && i < c ? 1 : c < a ? 2 : 0;
    for (int k = first; k < first + 3; ++k) triangle_[emitted_++] = turns[k];
  }

  void cut(Index i) {
    emit(i);
    const Index before = previous_[i], after = next_[i];
    next_[before] = after;
    previous_[after] = before;
    next_[i] = kNone;
    queue_[queue_end_++] = before;
    queue_[queue_end_++] = after;
  }

  In<Vec3> polygon_;
  Out<Index> triangle_;
  Index n_;
  View view_;
  Out<Index> previous_, next_, reflex_, queue_;
  Index num_reflex_ = 0, queue_end_ = 0, emitted_ = 0, forced_ = 0;
};

}  // namespace

void ear_clip(In<Vec3> polygon, Out<Index> triangle, Out<Index> scratch) {
  EarClipper(polygon, triangle, scratch).run();
}

}  // namespace planish
