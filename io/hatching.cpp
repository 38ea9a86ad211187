#include "io/hatching.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/feature_lines.hpp"
#include "io/page.hpp"

namespace planish {
namespace {

/// Sizes at a picture of 1600 pixels.
constexpr double kSmallestSpacing = 3;  // pixels
constexpr double kHatchWidth = 1.8, kBorderWidth = 3.2, kBorderRim = 6;

/// Where a hatching line meets the border.
struct Crossing {
  std::int64_t line = 0;
  double along = 0;
};

}  // namespace

std::vector<Vec2> hatch(In<std::vector<Vec2>> loops, Vec2 direction, double spacing) {
  const Vec2 normal{-direction.y, direction.x};
  std::vector<Crossing> crossing;
  for (const auto& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
      if (dot(a, normal) > dot(b, normal)) std::swap(a, b);
      const double low = dot(a, normal) / spacing, high = dot(b, normal) / spacing;
      // Half open: a line through a common end of two edges meets one of them, or both, or none.
      for (auto k = static_cast<std::int64_t>(std::ceil(low)); static_cast<double>(k) < high; ++k) {
        const double share = (static_cast<double>(k) - low) / (high - low);
        crossing.push_back({k, dot(a + share * (b - a), direction)});
      }
    }
  }
  std::ranges::sort(crossing, {}, [](const Crossing& c) { return std::pair(c.line, c.along); });
  std::vector<Vec2> segments;
  for (std::size_t i = 0; i + 1 < crossing.size(); i += 2) {
    for (const Crossing& c : {crossing[i], crossing[i + 1]}) {
      segments.push_back(c.along * direction + (static_cast<double>(c.line) * spacing) * normal);
    }
  }
  return segments;
}

void draw_hatched(Canvas& canvas, In<std::vector<Vec2>> loops, std::size_t number, double spacing,
                  double unit) {
  constexpr std::array kDegrees = {-45.0, 45.0, -20.0, 70.0};
  const Rgb colour = feature_colour(number);
  const Vec2 direction = planish::unit(kDegrees[number % kDegrees.size()] * kPi / 180);
  const std::vector<Vec2> lines = hatch(loops, direction, std::max(kSmallestSpacing, spacing));
  const double width = std::max(0.8, unit * kHatchWidth);
  canvas.segments(lines, {kPaper, 2.2 * width, 0.35});
  canvas.segments(lines, {colour, width, 0.8});
  for (const auto& loop : loops) canvas.polyline(loop, true, {kPaper, unit * kBorderRim, 0.75});
  for (const auto& loop : loops) canvas.polyline(loop, true, {colour, unit * kBorderWidth, 1});
}

}  // namespace planish
