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

TEST_CASE("sums: nothing sums to 0") { CHECK(pairwise_sum({}) == 0); }
