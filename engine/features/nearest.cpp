#include "engine/features/nearest.hpp"

#include <algorithm>
#include <tuple>

namespace planish {
namespace {

/// Distance from x to the interval spanned by three numbers.
double outside(double x, double a, double b, double c) {
  return std::max({std::min({a, b, c}) - x, x - std::max({a, b, c}), 0.0});
}

}  // namespace

bool is_finite_point(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

double squared_distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length2 = dot(along, along);
  const double s = length2 > 0 ? std::clamp(dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  // From the nearer end, so that the two directions of a segment differ by rounding of that end only.
  const Vec3 offset = s <= 0.5 ? p - a - s * along : p - b + (1 - s) * along;
  return dot(offset, offset);
}

double squared_distance_to_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 normal = cross(b - a, c - a);
  const double normal2 = dot(normal, normal);
  if (normal2 > 0 && dot(cross(b - a, p - a), normal) >= 0 && dot(cross(c - b, p - b), normal) >= 0 &&
      dot(cross(a - c, p - c), normal) >= 0) {
    const double height = dot(p - a, normal);
    return height * height / normal2;
  }
  return std::min({squared_distance_to_segment(p, a, b), squared_distance_to_segment(p, b, c),
                   squared_distance_to_segment(p, c, a)});
}

double squared_distance_to_box(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 offset{outside(p.x, a.x, b.x, c.x), outside(p.y, a.y, b.y, c.y), outside(p.z, a.z, b.z, c.z)};
  return dot(offset, offset);
}

bool comes_before(Vec3 a, Vec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

}  // namespace planish
