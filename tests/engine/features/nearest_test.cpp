#include "engine/features/nearest.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

Vec3 random_point(shapes::Random& random) {
  return {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
}

}  // namespace

TEST_CASE("nearest: a triangle is as near as the nearest of its points") {
  shapes::Random random(1);
  constexpr int kSteps = 60;
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 a = random_point(random), b = random_point(random), c = random_point(random);
    const Vec3 p = 2 * random_point(random);
    double sampled = kInfinity;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3 q = a + i * (1.0 / kSteps) * (b - a) + j * (1.0 / kSteps) * (c - a);
        sampled = std::min(sampled, norm(p - q));
      }
    }
    const double found = std::sqrt(squared_distance_to_triangle(p, a, b, c));
    CHECK(found <= sampled + 1e-12);
    CHECK(sampled - found < 4.0 / kSteps);
    CHECK(std::sqrt(squared_distance_to_box(p, a, b, c)) <= found + 1e-12);
  }
}

TEST_CASE("nearest: points over the inside, an edge and a corner have closed forms") {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  CHECK(squared_distance_to_triangle({1, 1, 3}, a, b, c) == doctest::Approx(9));
  CHECK(squared_distance_to_triangle({2, -2, 1}, a, b, c) == doctest::Approx(5));
  CHECK(squared_distance_to_triangle({-3, -4, 12}, a, b, c) == doctest::Approx(169));
  CHECK(squared_distance_to_segment({6, 0, 0}, a, b) == doctest::Approx(4));
  CHECK(squared_distance_to_segment({3, 4, 0}, a, a) == doctest::Approx(25));
}

TEST_CASE("nearest: a needle without area counts as its edges") {
  CHECK(squared_distance_to_triangle({1, 2, 0}, {0, 0, 0}, {4, 0, 0}, {2, 0, 0}) == doctest::Approx(4));
}
