#include "io/wireframe.hpp"

#include "io/page.hpp"

namespace planish {

std::size_t Wireframe::num_lines() const {
  std::size_t num_points = 0;
  for (const auto& points : points_) num_points += points.size();
  return num_points / 2;
}

void Wireframe::shift(Vec2 by) {
  for (auto& points : points_) {
    for (Vec2& p : points) p += by;
  }
}

void Wireframe::draw(Canvas& canvas) const {
  for (int k = 0; k < kClasses; ++k) {
    canvas.segments(points_[k], {kInk, 0.7, fading_.alpha * (k + 0.5) / kClasses});
  }
}

}  // namespace planish
