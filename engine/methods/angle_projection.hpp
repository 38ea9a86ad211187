// The part of a triangle in the Newton system of angles.
#pragma once

#include <array>

namespace planish {

/// One triangle's part of the inverse of the Lagrangian's Hessian with diagonal h, its own multiplier eliminated: the inverse on
/// changes that sum to 0. Definite where one of h is negative, too, if the others outweigh it.
struct Projection {
  std::array<double, 3> h;

  double determinant() const { return h[0] * h[1] + h[1] * h[2] + h[2] * h[0]; }
  std::array<double, 3> apply(const std::array<double, 3>& x) const {
    const double d01 = h[2] * (x[0] - x[1]), d12 = h[0] * (x[1] - x[2]), d20 = h[1] * (x[2] - x[0]);
    const double scale = 1 / determinant();
    return {scale * (d01 - d20), scale * (d12 - d01), scale * (d20 - d12)};
  }
  /// The least change of a given sum.
  std::array<double, 3> spread(double sum) const {
    const double scale = sum / determinant();
    return {scale * h[1] * h[2], scale * h[2] * h[0], scale * h[0] * h[1]};
  }
};

inline double dot3(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace planish
