#include "kernels/base/sums.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace planish;

TEST_CASE("sums: pairwise sum of a million tenths is closer to 1e5 than the plain sum") {
  const std::vector<double> tenth(1'000'000, 0.1);
  double plain = 0;
  for (const double x : tenth) plain += x;
  CHECK(std::abs(pairwise_sum(tenth) - 1e5) < 1e-10);
  CHECK(std::abs(plain - 1e5) > 1e-7);
}

TEST_CASE("sums: dot products of all lengths around the unrolling are exact on whole numbers") {
  for (int n = 0; n < 20; ++n) {
    std::vector<Vec2> a, b;
    double expected = 0;
    for (int i = 0; i < n; ++i) {
      a.push_back({1.0 + i, 2.0 * i});
      b.push_back({3.0 - i, 5.0});
      expected += (1.0 + i) * (3.0 - i) + 10.0 * i;
    }
    CHECK(dot(In<Vec2>(a), In<Vec2>(b)) == expected);
  }
}

TEST_CASE("sums: nothing sums to 0") { CHECK(pairwise_sum({}) == 0); }
