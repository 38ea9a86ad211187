// Edges as thin lines that fade as they come closer to each other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "io/canvas.hpp"

namespace planish {

/// Height of a triangle over its longest edge: how far apart its lines stand.
inline double line_spacing(Vec2 a, Vec2 b, Vec2 c) {
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return longest > 0 ? std::abs(cross(b - a, c - a)) / longest : 0;
}

/// How lines fade; spacings in pixels.
struct Fading {
  double closest = 0;  ///< lines that stand closer are left out, before they would merge into grey
  double full = 1;     ///< lines so far apart or farther do not fade
  double alpha = 1;    ///< of those
};

/// Lines by their opacity, so that each class is drawn at once.
class Wireframe {
 public:
  explicit Wireframe(const Fading& fading) : fading_(fading) {}

  /// Whether lines with this spacing are drawn.
  bool shows(double spacing) const { return spacing >= fading_.closest; }

  /// A line whose neighbours stand `spacing` apart; nothing where that is too close.
  void add(Vec2 a, Vec2 b, double spacing) {
    if (!shows(spacing)) return;
    const double strength = (spacing - fading_.closest) / (fading_.full - fading_.closest);
    auto& points = points_[static_cast<int>(std::min(strength, kMostStrength) * kClasses)];
    points.push_back(a);
    points.push_back(b);
  }

  std::size_t num_lines() const;
  void shift(Vec2 by);
  void draw(Canvas& canvas) const;

 private:
  static constexpr int kClasses = 8;
  static constexpr double kMostStrength = 0.999;  ///< the last class, not one more
  Fading fading_;
  std::array<std::vector<Vec2>, kClasses> points_;  ///< two points a line
};

}  // namespace planish
