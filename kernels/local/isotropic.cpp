#include "kernels/local/isotropic.hpp"

namespace planish {
namespace {

/// Derivatives of e(F, d) with F = |J|_F^2 and d = det J, linear in F.
struct InNormAndDeterminant {
  double value, by_f, by_d, by_fd, by_dd;
};

IsotropicTerms terms_of(const InNormAndDeterminant& e, const Wirtinger& j) {
  const double squared_p = dot(j.p, j.p), squared_q = dot(j.q, j.q);
  const double by_p = 2 * e.by_f + e.by_d, by_q = 2 * e.by_f - e.by_d;  // by |p|^2 and |q|^2
  return {.value = e.value,
          .across_p = 2 * by_p,
          .across_q = 2 * by_q,
          .pp = 2 * by_p + 4 * squared_p * (4 * e.by_fd + e.by_dd),
          .pq = -4 * std::sqrt(squared_p * squared_q) * e.by_dd,
          .qq = 2 * by_q + 4 * squared_q * (e.by_dd - 4 * e.by_fd)};
}

double squared_frobenius(const Wirtinger& j) { return 2 * (dot(j.p, j.p) + dot(j.q, j.q)); }
double determinant(const Wirtinger& j) { return dot(j.p, j.p) - dot(j.q, j.q); }

Vec2 direction(Vec2 z) {
  const double length = norm(z);
  return length > 0 ? (1 / length) * z : Vec2{1, 0};
}

}  // namespace

IsotropicTerms arap_terms(const Wirtinger& j) {
  constexpr double kLeastConformal =
      1e-12;  // below, every rotation is as close: the energy is not smooth there
  const double p = norm(j.p);
  return {.value = 2 * (p - 1) * (p - 1) + 2 * dot(j.q, j.q),
          .across_p = 4 * (p - 1) / std::max(p, kLeastConformal),
          .across_q = 4,
          .pp = 4,
          .pq = 0,
          .qq = 4};
}

IsotropicTerms barred_arap_terms(const Wirtinger& j, const Barrier& barrier) {
  IsotropicTerms terms = arap_terms(j);
  const double x = determinant(j) / barrier.delta;
  if (x >= 1) return terms;
  if (x <= 0) {
    terms.value = kInfinity;
    return terms;
  }
  // b(x) = (1 - x)^3 / x = 1/x - 3 + 3 x - x^2
  const double weight = barrier.weight, per_d = 1 / barrier.delta;
  const IsotropicTerms wall = terms_of({.value = weight * (1 - x) * (1 - x) * (1 - x) / x,
                                        .by_f = 0,
                                        .by_d = weight * per_d * (3 - 2 * x - 1 / (x * x)),
                                        .by_fd = 0,
                                        .by_dd = weight * per_d * per_d * (2 / (x * x * x) - 2)},
                                       j);
  return {.value = terms.value + wall.value,
          .across_p = terms.across_p + wall.across_p,
          .across_q = terms.across_q + wall.across_q,
          .pp = terms.pp + wall.pp,
          .pq = terms.pq + wall.pq,
          .qq = terms.qq + wall.qq};
}

IsotropicTerms symmetric_dirichlet_terms(const Wirtinger& j) {
  const double f = squared_frobenius(j), d = determinant(j);
  if (!(d > 0)) return {.value = kInfinity};
  const double inverse = 1 / d, squared = inverse * inverse;
  return terms_of({.value = f * (1 + squared),
                   .by_f = 1 + squared,
                   .by_d = -2 * f * squared * inverse,
                   .by_fd = -2 * squared * inverse,
                   .by_dd = 6 * f * squared * squared},
                  j);
}

IsotropicTerms untangling_terms(const Wirtinger& j, double epsilon) {
  const double d = determinant(j), root = std::hypot(epsilon, d);
  const double k = 1 / untangling_chi(d, epsilon);
  // chi' = chi / root, so k' = -k / root and k'' = k / root^2 + k d / root^3.
  const double k1 = -k / root, k2 = k / (root * root) * (1 + d / root);
  const double numerator = squared_frobenius(j) + d * d + 1;
  return terms_of({.value = numerator * k,
                   .by_f = k,
                   .by_d = 2 * d * k + numerator * k1,
                   .by_fd = k1,
                   .by_dd = 2 * k + 4 * d * k1 + numerator * k2},
                  j);
}

IsotropicTerms projected(const IsotropicTerms& terms) {
  IsotropicTerms result = terms;
  result.across_p = std::max(0.0, terms.across_p);
  result.across_q = std::max(0.0, terms.across_q);
  const double mean = 0.5 * (terms.pp + terms.qq), difference = 0.5 * (terms.pp - terms.qq);
  const double radius = std::hypot(difference, terms.pq);
  const double low = mean - radius, high = mean + radius;
  if (low >= 0) return result;
  if (high <= 0) {
    result.pp = result.pq = result.qq = 0;
    return result;
  }
  // high times the projector on its eigenvector: (M - low) / (high - low).
  const double scale = high / (2 * radius);
  result.pp = scale * (terms.pp - low);
  result.pq = scale * terms.pq;
  result.qq = scale * (terms.qq - low);
  return result;
}

std::array<std::array<Mat2, 3>, 3> corner_hessian(const CornerWeights& a, const Wirtinger& j,
                                                  const IsotropicTerms& terms) {
  const Vec2 to_p = conjugate(direction(j.p)), to_q = conjugate(direction(j.q));
  std::array<Vec2, 3> w, v;  // d|p| = Re(w dz), |p| d(arg p) = Im(w dz); v the same for q
  for (int i = 0; i < 3; ++i) {
    w[i] = multiply(to_p, a[i]);
    v[i] = multiply(to_q, conjugate(a[i]));
  }
  std::array<std::array<Mat2, 3>, 3> hessian;
  for (int i = 0; i < 3; ++i) {
    // As rows over (dx, dy): Re(w dz) = (w.x, -w.y), Im(w dz) = (w.y, w.x).
    const Vec2 rp{w[i].x, -w[i].y}, tp{w[i].y, w[i].x}, rq{v[i].x, -v[i].y}, tq{v[i].y, v[i].x};
    const Vec2 along_p = terms.pp * rp + terms.pq * rq, along_q = terms.pq * rp + terms.qq * rq;
    const Vec2 across_p = terms.across_p * tp, across_q = terms.across_q * tq;
    for (int k = 0; k < 3; ++k) {
      const auto entry = [&](double lp, double lq, double ap, double aq) {
        return std::array<double, 2>{lp * w[k].x + lq * v[k].x + ap * w[k].y + aq * v[k].y,
                                     -lp * w[k].y - lq * v[k].y + ap * w[k].x + aq * v[k].x};
      };
      const auto upper = entry(along_p.x, along_q.x, across_p.x, across_q.x);
      const auto lower = entry(along_p.y, along_q.y, across_p.y, across_q.y);
      hessian[i][k] = {upper[0], upper[1], lower[0], lower[1]};
    }
  }
  return hessian;
}

double first_flip(const std::array<Vec2, 3>& z, const std::array<Vec2, 3>& dz) {
  const Vec2 e = z[1] - z[0], f = z[2] - z[0], de = dz[1] - dz[0], df = dz[2] - dz[0];
  const double c = cross(e, f), b = cross(de, f) + cross(e, df), a = cross(de, df);  // a t^2 + b t + c
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0 || (a >= 0 && b >= 0)) return kInfinity;
  // c > 0: of both roots the least positive one is 2 c / (-b + sqrt(...)), without cancellation for b < 0.
  const double root = std::sqrt(discriminant);
  if (b <= 0) return 2 * c / (root - b);
  return a < 0 ? (b + root) / (-2 * a) : kInfinity;
}

}  // namespace planish
