// Signed singular values of 2x2 matrices.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// sigma_max >= |sigma_min|; sigma_min has the sign of the determinant.
struct SingularValues {
  double sigma_max = 0, sigma_min = 0;
};

/// Through the conformal and anti-conformal parts a and b of J: sigma = |a| +- |b|.
inline SingularValues singular_values(const Mat2& j) {
  const double a = 0.5 * std::hypot(j.m00 + j.m11, j.m10 - j.m01);
  const double b = 0.5 * std::hypot(j.m00 - j.m11, j.m10 + j.m01);
  return {a + b, a - b};
}

///   jacobian [T];  sigma [T] out.
void singular_values(Range r, In<Mat2> jacobian, Out<SingularValues> sigma);

}  // namespace planish
