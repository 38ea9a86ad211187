#include "kernels/exact/orient2.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

int orient_by_cgal(Vec2 a, Vec2 b, Vec2 c) {
  using K = CGAL::Exact_predicates_inexact_constructions_kernel;
  return CGAL::orientation(K::Point_2(a.x, a.y), K::Point_2(b.x, b.y), K::Point_2(c.x, c.y));
}

}  // namespace

TEST_CASE("orient2: agrees with CGAL's exact predicate a few units in the last place around a line") {
  // Shewchuk's picture: points of a tiny grid near the diagonal, where the rounded determinant has wrong
  // signs.
  constexpr double kUlp = 0x1p-53;
  int disagreements = 0, rounded_wrong = 0;
  for (int i = 0; i < 128; ++i) {
    for (int j = 0; j < 128; ++j) {
      const Vec2 a{0.5 + i * kUlp, 0.5 + j * kUlp}, b{12, 12}, c{24, 24};
      const int exact = orient_by_cgal(a, b, c);
      const double det = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      disagreements += orient2(a, b, c) != exact;
      rounded_wrong += (det > 0) - (det < 0) != exact;
    }
  }
  CHECK(disagreements == 0);
  CHECK(rounded_wrong > 1000);
}

TEST_CASE("orient2: turning the points keeps the sign, swapping two reverses it, also far from the origin") {
  shapes::Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const double far = k % 2 == 0 ? 0 : 1e7;
    const auto point = [&] { return Vec2{far + random.uniform(), far + random.uniform()}; };
    const Vec2 a = point(), b = point();
    const Vec2 c = k % 3 == 0 ? 0.5 * (a + b) : point();
    const int sign = orient2(a, b, c);
    REQUIRE(sign == orient_by_cgal(a, b, c));
    REQUIRE(orient2(b, c, a) == sign);
    REQUIRE(orient2(b, a, c) == -sign);
  }
}

TEST_CASE("orient2: points on one line give 0") {
  CHECK(orient2({0, 0}, {1, 1}, {3, 3}) == 0);
  CHECK(orient2({0.1, 0.1}, {0.2, 0.2}, {0.3, 0.3}) == 0);
  CHECK(orient2({1e-300, 0}, {1e-300, 0}, {5, 5}) == 0);
}
