#include "kernels/exact/orient2.hpp"

#include <array>

namespace planish {
namespace {

/// Exact value as a sum of doubles that do not overlap, smallest first.
template <int N>
struct Expansion {
  std::array<double, N> term{};
  int size = 0;

  /// Adds one double exactly (Shewchuk's GROW-EXPANSION).
  void add(double value) {
    double carry = value;
    for (int i = 0; i < size; ++i) {
      const double sum = carry + term[i];
      const double virtual_part = sum - carry;
      term[i] = (carry - (sum - virtual_part)) + (term[i] - virtual_part);
      carry = sum;
    }
    term[size++] = carry;
  }

  /// Adds sign * x * y exactly.
  void add_product(double x, double y, double sign) {
    const double product = x * y;
    add(sign * std::fma(x, y, -product));
    add(sign * product);
  }

  /// Sign of the largest nonzero term.
  int sign() const {
    for (int i = size - 1; i >= 0; --i) {
      if (term[i] != 0) return term[i] > 0 ? 1 : -1;
    }
    return 0;
  }
};

int sign_of_expanded_determinant(Vec2 a, Vec2 b, Vec2 c) {
  // a x b + b x c + c x a, six products of coordinates as they are: no rounded difference enters.
  Expansion<12> sum;
  sum.add_product(a.x, b.y, 1);
  sum.add_product(a.y, b.x, -1);
  sum.add_product(b.x, c.y, 1);
  sum.add_product(b.y, c.x, -1);
  sum.add_product(c.x, a.y, 1);
  sum.add_product(c.y, a.x, -1);
  return sum.sign();
}

}  // namespace

int orient2(Vec2 a, Vec2 b, Vec2 c) {
  // Shewchuk's error bound of the plain evaluation, (3 + 16 eps) eps with eps = 2^-53.
  constexpr double kEps = std::numeric_limits<double>::epsilon() / 2;
  constexpr double kBound = (3 + 16 * kEps) * kEps;
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  if (std::abs(det) > kBound * (std::abs(left) + std::abs(right))) return det > 0 ? 1 : -1;
  return sign_of_expanded_determinant(a, b, c);
}

}  // namespace planish
