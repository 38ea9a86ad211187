// Energies of a triangle's map that no rotation changes, with derivatives and projected Hessians in closed form.
#pragma once

#include <algorithm>
#include <array>

#include "kernels/intrinsic/lengths.hpp"
#include "kernels/local/proxy.hpp"

namespace planish {

/// The Jacobian as a map of complex numbers, J h = p h + q conj(h): |J|_F^2 = 2 (|p|^2 + |q|^2), det J = |p|^2 - |q|^2,
/// singular values |p| +- |q|. An energy that rotations of either plane do not change is a function of |p| and |q| alone.
struct Wirtinger {
  Vec2 p, q;
};

/// a with p = sum of a_i z_i and q = sum of conj(a_i) z_i over the corners.
using CornerWeights = std::array<Vec2, 3>;

inline CornerWeights corner_weights(const RestFrame& f) {
  const double scale = 0.5 / (f.x1 * f.y2);
  // p = (dz_1 conj(x_2) - dz_2 x_1) / (-2 i x_1 y_2), and 1 / (-i) = i.
  const Vec2 a1 = scale * Vec2{f.y2, f.x2}, a2 = scale * Vec2{0, -f.x1};
  return {-(a1 + a2), a1, a2};
}

inline Wirtinger wirtinger(const CornerWeights& a, const std::array<Vec2, 3>& z) {
  const Vec2 d1 = z[1] - z[0], d2 = z[2] - z[0];
  return {multiply(a[1], d1) + multiply(a[2], d2),
          multiply(conjugate(a[1]), d1) + multiply(conjugate(a[2]), d2)};
}

/// An energy density e(|p|, |q|): its value, the first derivatives over |p| and |q| (its curvature across p and q), and
/// the second derivatives.
struct IsotropicTerms {
  double value = 0;
  double across_p = 0, across_q = 0;
  double pp = 0, pq = 0, qq = 0;
};

/// What the barrier adds to ARAP: weight * (1 - d/delta)^3 / (d/delta) for det J = d < delta, infinite for d <= 0. A lower
/// or thinner one costs less energy and more time: what is squeezed crumples before it meets the barrier. Measured in
/// perf/README.md.   Ref: DESIGN 3.6.
struct Barrier {
  double weight = 5e-3, delta = 0.2;
};

/// ARAP: |J - R|_F^2 with the closest rotation R, 2 (|p| - 1)^2 + 2 |q|^2.
IsotropicTerms arap_terms(const Wirtinger& j);
/// The same and the barrier.
IsotropicTerms barred_arap_terms(const Wirtinger& j, const Barrier& barrier);
/// |J|_F^2 + |J^-1|_F^2; infinite for det J <= 0.   Ref: Smith and Schaefer 2015, no factor 1/2.
IsotropicTerms symmetric_dirichlet_terms(const Wirtinger& j);

/// (|J|_F^2 + det^2 + 1) / chi(det), chi(d) = (d + sqrt(epsilon^2 + d^2)) / 2: finite for every J while epsilon > 0.
/// Ref: Garanzha et al. 2021, with lambda = 1.
IsotropicTerms untangling_terms(const Wirtinger& j, double epsilon);
/// chi, accurate for negative d too.
inline double untangling_chi(double d, double epsilon) {
  const double root = std::hypot(epsilon, d);
  return d > 0 ? 0.5 * (d + root) : 0.5 * epsilon * epsilon / (root - d);
}

/// The positive semidefinite matrix nearest to the Hessian in (p, q): eigenvalues below 0 become 0. Closed form: across p
/// and across q are eigenvectors, what is left is a 2x2 matrix.
IsotropicTerms projected(const IsotropicTerms& terms);

/// Derivatives of the density with respect to the corners.
inline std::array<Vec2, 3> corner_gradient(const CornerWeights& a, const Wirtinger& j,
                                           const IsotropicTerms& terms) {
  const Vec2 p = terms.across_p * j.p, q = terms.across_q * j.q;
  std::array<Vec2, 3> gradient;
  for (int i = 0; i < 3; ++i) gradient[i] = multiply(p, conjugate(a[i])) + multiply(q, a[i]);
  return gradient;
}

/// The density plus a multiple of det J: the sum of det J over a mesh is the area of its image, which vertices inside do not
/// change. ARAP plus 2 det J is 4 |p|^2 - 4 |p| + 2, convex wherever |p| >= 1/2.
inline IsotropicTerms plus_determinant(IsotropicTerms terms, const Wirtinger& j, double multiple) {
  terms.value += multiple * (dot(j.p, j.p) - dot(j.q, j.q));
  terms.across_p += 2 * multiple;
  terms.pp += 2 * multiple;
  terms.across_q -= 2 * multiple;
  terms.qq -= 2 * multiple;
  return terms;
}

/// Second derivatives with respect to the corners, blocks [3][3].
std::array<std::array<Mat2, 3>, 3> corner_hessian(const CornerWeights& a, const Wirtinger& j,
                                                  const IsotropicTerms& terms);

/// Least t > 0 at which the triangle z + t dz has no area; kInfinity where it keeps it for ever. Pre: positive area at 0.
double first_flip(const std::array<Vec2, 3>& z, const std::array<Vec2, 3>& dz);

}  // namespace planish
