#include "kernels/intrinsic/cotangents.hpp"

#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

TEST_CASE("cotangents: are those of the corner angles") {
  const RestFrame frame = rest_frame({0, 0, 0}, {3, 0, 1}, {1, 2, -1});
  const auto angle = corner_angles(frame);
  const Cotangents cot = cotangents(frame);
  CHECK_FALSE(cot.mollified);
  for (int i = 0; i < 3; ++i) CHECK(cot.at[i] == Approx(1 / std::tan(angle[i])));
}

TEST_CASE("cotangents: products of pairs sum to 1, for needles too") {
  // cot a cot b + cot b cot c + cot c cot a = 1 holds for the angles of every triangle: floored weights stay
  // those of one.
  for (const double height : {1.0, 1e-3, 1e-5, 1e-9, 0.0}) {
    const Cotangents cot = cotangents(rest_frame({0, 0, 0}, {1, 0, 0}, {0.3, height, 0}));
    const auto& c = cot.at;
    CHECK(c[0] * c[1] + c[1] * c[2] + c[2] * c[0] == Approx(1).epsilon(1e-5));
    CHECK(cot.mollified == (height < kLeastAltitude));
    for (const double x : c) CHECK(std::abs(x) <= 1 / kLeastAltitude);
  }
}

TEST_CASE("lengths: corner angles sum to pi and the frame keeps all three edge lengths") {
  shapes::Random random(5);
  for (int k = 0; k < 1000; ++k) {
    const auto point = [&] { return Vec3{random.uniform(), random.uniform(), random.uniform()}; };
    const Vec3 a = point(), b = point(), c = point();
    const RestFrame frame = rest_frame(a, b, c);
    const auto edge = edge_vectors(frame);
    CHECK(norm(edge[0]) == Approx(norm(b - a)));
    CHECK(norm(edge[1]) == Approx(norm(c - b)));
    CHECK(norm(edge[2]) == Approx(norm(a - c)));
    const auto angle = corner_angles(frame);
    CHECK(angle[0] + angle[1] + angle[2] == Approx(kPi));
  }
}
