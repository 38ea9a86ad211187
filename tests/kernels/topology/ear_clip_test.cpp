#include "kernels/topology/ear_clip.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

using namespace planish;

namespace {

std::vector<Index> clip(const std::vector<Vec3>& polygon) {
  std::vector<Index> triangle(3 * (polygon.size() - 2), kNone);
  std::vector<Index> scratch(ear_clip_scratch(static_cast<Offset>(polygon.size())));
  ear_clip(polygon, triangle, scratch);
  return triangle;
}

Vec3 twice_area(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }

/// A cut without overlap: all triangles turn like the polygon and their areas add up to its own.
void check_covers(const std::vector<Vec3>& polygon) {
  const std::vector<Index> triangle = clip(polygon);
  Vec3 whole;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    whole = whole + twice_area(polygon[0], polygon[i], polygon[i + 1]);
  }
  double sum = 0;
  for (std::size_t c = 0; c < triangle.size(); c += 3) {
    const Vec3 area = twice_area(polygon[triangle[c]], polygon[triangle[c + 1]], polygon[triangle[c + 2]]);
    CHECK(dot(area, whole) >= 0);
    sum += norm(area);
  }
  CHECK(sum == doctest::Approx(norm(whole)).epsilon(1e-12));
}

/// A star-shaped polygon with random radii, in a plane across the axes.
std::vector<Vec3> star(int corners, unsigned seed, double least_radius) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(least_radius, 1);
  std::vector<Vec3> polygon;
  for (int i = 0; i < corners; ++i) {
    const Vec2 p = radius(random) * unit(2 * kPi * i / corners);
    polygon.push_back({100 + p.x, 0.3 * p.x + p.y, 0.5 * p.y - 0.2 * p.x});
  }
  return polygon;
}

}  // namespace

TEST_CASE("ear_clip: a convex polygon becomes the fan of its first corner") {
  const std::vector<Vec3> hexagon = star(6, 1, 1.0);
  CHECK(clip(hexagon) == std::vector<Index>{0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5});
}

TEST_CASE("ear_clip: a concave quad is cut along its inner diagonal") {
  const std::vector<Vec3> arrow = {{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};
  // The outer diagonal 1-3 would leave the polygon.
  CHECK(clip(arrow) == std::vector<Index>{0, 1, 2, 0, 2, 3});
  const std::vector<Vec3> turned = {{2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}, {0, 0, 0}};
  CHECK(clip(turned) == std::vector<Index>{1, 2, 3, 0, 1, 3});
}

TEST_CASE("ear_clip: concave polygons are covered without overlap, in any plane and direction") {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::vector<Vec3> polygon = star(5 + static_cast<int>(seed), seed, 0.1);
    check_covers(polygon);
    std::ranges::reverse(polygon);
    check_covers(polygon);
    for (Vec3& p : polygon) p = {p.z, p.x, p.y};
    check_covers(polygon);
  }
}

TEST_CASE("ear_clip: a hole joined by a bridge stays open") {
  const std::vector<Vec3> frame = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                                   {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  check_covers(frame);
}

TEST_CASE("ear_clip: points on a straight edge and a comb of teeth") {
  check_covers({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}});
  std::vector<Vec3> comb;
  for (int i = 0; i < 40; ++i) comb.push_back({double(i), i % 2 == 0 ? 0.0 : 5.0, 1});
  comb.push_back({39, -1, 1});
  comb.push_back({0, -1, 1});
  check_covers(comb);
}

TEST_CASE("ear_clip: degenerate, crossing and non-finite polygons still give n - 2 triangles") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<Vec3>> polygons = {
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1.5, 0, 0}},
      {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},
      {{nan, 0, 0}, {1, nan, 0}, {1, 0, kInfinity}, {0, 1, 0}, {2, 2, 2}},
      star(500, 3, -1.0)};
  for (const auto& polygon : polygons) {
    const std::vector<Index> triangle = clip(polygon);
    std::vector<int> used(polygon.size(), 0);
    for (const Index i : triangle) {
      REQUIRE(i >= 0);
      REQUIRE(i < static_cast<Index>(polygon.size()));
      ++used[i];
    }
    CHECK(std::ranges::count(used, 0) == 0);
  }
}
