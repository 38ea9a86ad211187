// Energies of a triangle from its signed singular values.
#pragma once

#include "kernels/local/svd2.hpp"

namespace planish {

/// |J - R|_F^2 for the closest rotation: (s1 - 1)^2 + (s2 - 1)^2 with signed s2.
inline double arap(SingularValues s) {
  return (s.sigma_max - 1) * (s.sigma_max - 1) + (s.sigma_min - 1) * (s.sigma_min - 1);
}

/// |J|_F^2 + |J^-1|_F^2; 4 for an isometry, infinite where sigma_min <= 0.
/// Ref: Smith and Schaefer 2015, no
/// factor 1/2.
inline double symmetric_dirichlet(SingularValues s) {
  if (!(s.sigma_min > 0)) return kInfinity;
  const double a = s.sigma_max * s.sigma_max, b = s.sigma_min * s.sigma_min;
  return a + b + 1 / a + 1 / b;
}

}  // namespace planish
