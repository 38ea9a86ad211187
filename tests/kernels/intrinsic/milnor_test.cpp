#include "kernels/intrinsic/milnor.hpp"

#include <doctest/doctest.h>

#include "kernels/base/types.hpp"

using namespace planish;

namespace {

/// -integral of log |2 sin t| from 0 to x by the midpoint rule, the singularity at 0 taken out: log(2 t) has a closed integral.
double lobachevsky_by_sum(double x) {
  constexpr int kCells = 20000;
  double sum = 0;
  for (int i = 0; i < kCells; ++i) {
    const double t = x * (i + 0.5) / kCells;
    sum += std::log(std::sin(t) / t) * x / kCells;
  }
  return -(sum + x * std::log(2 * x) - x);
}

}  // namespace

TEST_CASE(
    "lobachevsky: its largest value, at pi / 6, is Milnor's 0.5074708, and it is 0 at multiples of pi / 2") {
  CHECK(lobachevsky(kPi / 6) == doctest::Approx(0.50747080320482).epsilon(1e-13));
  CHECK(std::abs(lobachevsky(kPi / 2)) < 1e-15);
  CHECK(lobachevsky(0) == 0);
  CHECK(std::abs(lobachevsky(kPi)) < 1e-15);
}

TEST_CASE("lobachevsky: agrees with its integral") {
  for (const double x : {0.01, 0.3, 0.9, kPi / 3, 1.2, 1.5, 2.0, 2.7})
    CHECK(lobachevsky(x) == doctest::Approx(lobachevsky_by_sum(x)).epsilon(1e-8));
}

TEST_CASE("lobachevsky: is odd, has period pi, and L(2 x) = 2 L(x) + 2 L(x + pi / 2)") {
  for (const double x : {0.05, 0.4, 0.77, 1.3, 1.56}) {
    CHECK(lobachevsky(-x) == -lobachevsky(x));
    CHECK(lobachevsky(x + kPi) == doctest::Approx(lobachevsky(x)).epsilon(1e-13));
    CHECK(lobachevsky(2 * x) ==
          doctest::Approx(2 * lobachevsky(x) + 2 * lobachevsky(x + kPi / 2)).epsilon(1e-13));
  }
}

TEST_CASE(
    "triangle angles: those of a 3 4 5 triangle at any scale, and pi opposite an edge that is too long") {
  for (const double scale : {-200.0, 0.0, 200.0}) {
    const TriangleAngles t =
        triangle_angles({std::log(3.0) + scale, std::log(4.0) + scale, std::log(5.0) + scale});
    CHECK(!t.broken);
    CHECK(t.angle[0] == doctest::Approx(std::atan2(3, 4)).epsilon(1e-12));
    CHECK(t.angle[1] == doctest::Approx(std::atan2(4, 3)).epsilon(1e-12));
    CHECK(t.angle[2] == doctest::Approx(kPi / 2).epsilon(1e-12));
  }
  const TriangleAngles flat = triangle_angles({0, std::log(3.0), 0});
  CHECK(flat.broken);
  CHECK(flat.angle[0] == 0);
  CHECK(flat.angle[1] == kPi);
}
