#include "kernels/intrinsic/milnor.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/base/types.hpp"

namespace planish {
namespace {

constexpr int kTerms = 16;  // each a ninth of the one before, or less

/// zeta(2 k) for k = 1, 2, ...
constexpr std::array<double, kTerms> kZeta = {
    1.6449340668482264365, 1.0823232337111381915, 1.0173430619844491397, 1.0040773561979443394,
    1.0009945751278180853, 1.0002460865533080483, 1.0000612481350587048, 1.0000152822594086519,
    1.0000038172932649998, 1.0000009539620338728, 1.0000002384505027277, 1.0000000596081890513,
    1.0000000149015548284, 1.0000000037253340248, 1.0000000009313274324, 1.0000000002328311834};

/// Clausen function at x in [0, 2 pi / 3].
double clausen_near_zero(double x) {
  if (x == 0) return 0;
  const double q = x / (2 * kPi) * (x / (2 * kPi));
  double sum = 0;
  for (int k = kTerms; k >= 1; --k) sum = q * (sum + kZeta[k - 1] / (k * (2 * k + 1)));
  return x * (1 - std::log(x) + sum);
}

/// Clausen function at pi - x, x in [0, pi / 3].
double clausen_near_pi(double x) {
  const double q = x / kPi * (x / kPi);
  double sum = 0;
  for (int k = kTerms; k >= 1; --k)
    sum = q * (sum + kZeta[k - 1] * (1 - std::ldexp(1.0, -2 * k)) / (k * (2 * k + 1)));
  return x * (std::log(2.0) - sum);
}

}  // namespace

double lobachevsky(double x) {
  const double twice = 2 * std::remainder(x, kPi);  // in [-pi, pi]
  const double y = std::abs(twice);
  const double clausen = y <= 2 * kPi / 3 ? clausen_near_zero(y) : clausen_near_pi(kPi - y);
  return std::copysign(0.5 * clausen, twice);
}

TriangleAngles triangle_angles(const std::array<double, 3>& log_length) {
  const double longest = std::max({log_length[0], log_length[1], log_length[2]});
  std::array<double, 3> length;
  for (int i = 0; i < 3; ++i) length[i] = std::exp(log_length[i] - longest);
  TriangleAngles result;
  for (int i = 0; i < 3; ++i) {
    if (!(length[i] >= length[(i + 1) % 3] + length[(i + 2) % 3])) continue;
    result.angle[i] = kPi;
    result.broken = true;
    return result;
  }
  const double half = 0.5 * (length[0] + length[1] + length[2]);
  for (int i = 0; i < 3; ++i) {
    const double b = length[(i + 1) % 3], c = length[(i + 2) % 3];
    result.angle[i] =
        2 * std::atan2(std::sqrt((half - b) * (half - c)), std::sqrt(half * (half - length[i])));
  }
  return result;
}

}  // namespace planish
