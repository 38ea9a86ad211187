#include "io/view.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace planish {
namespace {

using Components = std::array<double, 3>;
using Symmetric3 = std::array<Components, 3>;

Components components(Vec3 p) { return {p.x, p.y, p.z}; }
Vec3 axis(int i) { return {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0}; }

Vec3 multiply(const Symmetric3& m, Vec3 p) {
  const auto row = [&](int i) { return m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z; };
  return {row(0), row(1), row(2)};
}

/// Integrals over a surface; moments about a point of it.
struct Integrals {
  double doubled_area = 0;
  Vec3 doubled_normal, first;
  Symmetric3 second{};  ///< the lower half while it is added up

  void add(const Surface& surface, Index t, Vec3 origin) {
    const auto corner = [&](int i) { return surface.position[surface.corner_vertex[3 * t + i]] - origin; };
    const std::array<Vec3, 3> p = {corner(0), corner(1), corner(2)};
    const Vec3 n = cross(p[1] - p[0], p[2] - p[0]), sum = p[0] + p[1] + p[2];
    const double area = norm(n);
    doubled_area += area;
    doubled_normal = doubled_normal + n;
    first = first + (area / 3) * sum;
    const std::array<Components, 4> parts = {components(p[0]), components(p[1]), components(p[2]),
                                             components(sum)};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        double products = 0;
        for (const Components& q : parts) products += q[i] * q[j];
        second[i][j] += area / 12 * products;
      }
    }
  }
  void add(const Integrals& other) {
    doubled_area += other.doubled_area;
    doubled_normal = doubled_normal + other.doubled_normal;
    first = first + other.first;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) second[i][j] += other.second[i][j];
    }
  }
};

Integrals integrate(const Exec& exec, const Surface& surface) {
  std::vector<Integrals> partial(Exec::num_blocks(surface.num_triangles(), kBlock));
  exec.for_blocks(surface.num_triangles(), kBlock, [&](Index k, Range r) {
    const Vec3 origin = surface.position[surface.corner_vertex[0]];
    for (Index t = r.begin; t < r.end; ++t) partial[k].add(surface, t, origin);
  });
  Integrals total;
  for (const Integrals& part : partial) total.add(part);
  return total;
}

/// Second moments about the mean, of a unit of area.
Symmetric3 central_moments(const Integrals& integrals) {
  const Components mean = components((1 / integrals.doubled_area) * integrals.first);
  Symmetric3 m{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      m[i][j] = m[j][i] = integrals.second[i][j] / integrals.doubled_area - mean[i] * mean[j];
    }
  }
  return m;
}

/// Of the smallest moment, by power iteration on the moments' complement. Where several are as small it is
/// any direction between them, and that will do.
Vec3 least_direction(const Symmetric3& m) {
  constexpr int kSteps = 300;
  const double trace = m[0][0] + m[1][1] + m[2][2];
  Vec3 direction = (1 / norm(Vec3{0.4, 0.5, 0.8})) * Vec3{0.4, 0.5, 0.8};
  for (int step = 0; step < kSteps && trace > 0; ++step) {
    const Vec3 next = trace * direction - multiply(m, direction);
    direction = (1 / norm(next)) * next;
  }
  return direction;
}

/// The direction or its opposite, so that its largest component is positive.
Vec3 along_axes(Vec3 direction) {
  const Components c = components(direction);
  int largest = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(c[i]) > std::abs(c[largest]) * (1 + 1e-9)) largest = i;
  }
  return c[largest] < 0 ? -1.0 * direction : direction;
}

Vec3 in_picture(Vec3 p, Vec3 toward) { return p - dot(p, toward) * toward; }

/// The coordinate axis that is seen longest, as it is seen.
Vec3 longest_axis(Vec3 toward) {
  Vec3 best;
  for (int i = 0; i < 3; ++i) {
    const Vec3 seen = in_picture(axis(i), toward);
    if (norm(seen) > norm(best) * (1 + 1e-9)) best = seen;
  }
  return (1 / norm(best)) * best;
}

/// Across the picture: the direction of the largest moment there; a coordinate axis where none stands out or
/// one is near.
Vec3 choose_right(const Symmetric3& m, Vec3 toward) {
  constexpr double kClear = 0.05, kNear = kPi / 18;
  const Vec3 a = longest_axis(toward), b = cross(toward, a);
  const double aa = dot(a, multiply(m, a)), bb = dot(b, multiply(m, b)), ab = dot(a, multiply(m, b));
  const bool clear = std::hypot(aa - bb, 2 * ab) > kClear * (aa + bb);
  double angle = clear ? 0.5 * std::atan2(2 * ab, aa - bb) : 0;
  const double quarter = std::round(angle / (kPi / 2)) * (kPi / 2);
  if (std::abs(angle - quarter) < kNear) angle = quarter;
  const Vec2 turn = unit(angle);
  const Vec3 up = along_axes(turn.x * b - turn.y * a);  // what is up in space is rarely down in the picture
  return cross(up, toward);
}

}  // namespace

View choose_view(const Exec& exec, const Surface& surface) {
  constexpr double kCancelled = 0.1;  // mean normal, of an area whose triangles all face one way 1
  const Integrals integrals = integrate(exec, surface);
  const double area = integrals.doubled_area;
  if (!(area > 0) || !std::isfinite(area)) return {};
  const Symmetric3 m = central_moments(integrals);
  const double size = norm(integrals.doubled_normal);
  View view;
  view.toward =
      size > kCancelled * area ? (1 / size) * integrals.doubled_normal : along_axes(least_direction(m));
  view.right = choose_right(m, view.toward);
  view.up = cross(view.toward, view.right);
  return view;
}

}  // namespace planish
