#include "kernels/local/isotropic.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <random>

#include "kernels/exact/orient2.hpp"
#include "kernels/local/distortion.hpp"
#include "kernels/local/jacobians.hpp"
#include "tests/support/jet.hpp"

using namespace planish;
using planish::tests::Jet;

namespace {

using Corners = std::array<Vec2, 3>;
using Terms = std::function<IsotropicTerms(const Wirtinger&)>;

const RestFrame kFrame{1.3, 0.4, 0.9};

/// The densities, each with a name and whether it is finite for flipped triangles.
struct Density {
  const char* name;
  Terms terms;
  bool finite;
};
const std::vector<Density> kDensities = {
    {"arap", [](const Wirtinger& j) { return arap_terms(j); }, true},
    {"barred arap", [](const Wirtinger& j) { return barred_arap_terms(j, {.weight = 0.3, .delta = 2}); },
     false},
    {"symmetric dirichlet", [](const Wirtinger& j) { return symmetric_dirichlet_terms(j); }, false},
    {"untangling", [](const Wirtinger& j) { return untangling_terms(j, 0.3); }, true},
    {"arap and area", [](const Wirtinger& j) { return plus_determinant(arap_terms(j), j, 2); }, true}};

Corners random_corners(std::mt19937& random, bool positive) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  while (true) {
    const Corners z{Vec2{coordinate(random), coordinate(random)},
                    Vec2{coordinate(random), coordinate(random)},
                    Vec2{coordinate(random), coordinate(random)}};
    const double doubled = cross(z[1] - z[0], z[2] - z[0]);
    if (std::abs(doubled) > 0.2 && (doubled > 0 || !positive)) return z;
  }
}

double& entry(Corners& z, int i) { return i % 2 == 0 ? z[i / 2].x : z[i / 2].y; }
double entry(const Mat2& m, int row, int column) {
  return row == 0 ? (column == 0 ? m.m00 : m.m01) : (column == 0 ? m.m10 : m.m11);
}

double value_at(const Terms& terms, const Corners& z) {
  return terms(wirtinger(corner_weights(kFrame), z)).value;
}
Corners gradient_at(const Terms& terms, const Corners& z) {
  const CornerWeights a = corner_weights(kFrame);
  const Wirtinger j = wirtinger(a, z);
  return corner_gradient(a, j, terms(j));
}

/// x^T H x for the blocks of a Hessian.
double curvature(const std::array<std::array<Mat2, 3>, 3>& hessian, Corners x) {
  double sum = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 6; ++k) sum += entry(x, i) * entry(hessian[i / 2][k / 2], i % 2, k % 2) * entry(x, k);
  }
  return sum;
}

/// The densities from the entries of the Jacobian, without p and q, over the six coordinates.
Jet<6> twin_of(const Density& density, const Corners& z) {
  std::array<Jet<6>, 6> x;
  for (int i = 0; i < 6; ++i) x[i] = Jet<6>::variable(i % 2 == 0 ? z[i / 2].x : z[i / 2].y, i);
  const Jet<6> along(1 / kFrame.x1), shear(-kFrame.x2 / (kFrame.x1 * kFrame.y2)), across(1 / kFrame.y2);
  const Jet<6> m00 = along * (x[2] - x[0]), m10 = along * (x[3] - x[1]);
  const Jet<6> m01 = shear * (x[2] - x[0]) + across * (x[4] - x[0]),
               m11 = shear * (x[3] - x[1]) + across * (x[5] - x[1]);
  const Jet<6> f = m00 * m00 + m01 * m01 + m10 * m10 + m11 * m11, d = m00 * m11 - m01 * m10;
  const std::string name = density.name;
  if (name == "symmetric dirichlet") return f + f * inverse(d * d);
  if (name == "untangling")
    return (f + d * d + Jet<6>(1)) * inverse(Jet<6>(0.5) * (d + root(d * d + Jet<6>(0.09))));
  const Jet<6> arap = f - Jet<6>(2) * root(f + Jet<6>(2) * d) + Jet<6>(2);  // |J|^2 - 2 (s1 + s2) + 2
  if (name == "arap and area") return arap + Jet<6>(2) * d;
  const Jet<6> y = Jet<6>(0.5) * d, gap = Jet<6>(1) - y;
  return name == "barred arap" && y.value < 1 ? arap + Jet<6>(0.3) * gap * gap * gap * inverse(y) : arap;
}

}  // namespace

TEST_CASE("isotropic: p and q have the singular values and the determinant of the Jacobian") {
  std::mt19937 random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Corners z = random_corners(random, false);
    const Wirtinger j = wirtinger(corner_weights(kFrame), z);
    const Mat2 m = jacobian(kFrame, z[0], z[1], z[2]);
    const SingularValues s = singular_values(m);
    CHECK(norm(j.p) + norm(j.q) == doctest::Approx(s.sigma_max).epsilon(1e-12));
    CHECK(norm(j.p) - norm(j.q) == doctest::Approx(s.sigma_min).epsilon(1e-12));
    CHECK(dot(j.p, j.p) - dot(j.q, j.q) == doctest::Approx(determinant(m)).epsilon(1e-12));
  }
}

TEST_CASE("isotropic: densities are those of the matrix they are defined by") {
  std::mt19937 random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const Corners z = random_corners(random, true);
    const Mat2 m = jacobian(kFrame, z[0], z[1], z[2]);
    const double f = squared_norm(m), d = determinant(m), x = d / 2;
    CHECK(value_at(kDensities[0].terms, z) == doctest::Approx(arap(singular_values(m))).epsilon(1e-12));
    const double wall = x < 1 ? 0.3 * std::pow(1 - x, 3) / x : 0;
    CHECK(value_at(kDensities[1].terms, z) ==
          doctest::Approx(arap(singular_values(m)) + wall).epsilon(1e-12));
    CHECK(value_at(kDensities[2].terms, z) ==
          doctest::Approx(symmetric_dirichlet(singular_values(m))).epsilon(1e-12));
    const double chi = 0.5 * (d + std::sqrt(0.09 + d * d));
    CHECK(value_at(kDensities[3].terms, z) == doctest::Approx((f + d * d + 1) / chi).epsilon(1e-12));
  }
}

TEST_CASE("isotropic: gradients and Hessians are those of central differences") {
  std::mt19937 random(3);
  constexpr double kStep = 1e-6;
  for (const Density& density : kDensities) {
    CAPTURE(density.name);
    for (int trial = 0; trial < 50; ++trial) {
      const Corners z = random_corners(random, !density.finite);
      const CornerWeights a = corner_weights(kFrame);
      const Wirtinger j = wirtinger(a, z);
      Corners gradient = corner_gradient(a, j, density.terms(j));
      const auto hessian = corner_hessian(a, j, density.terms(j));
      for (int k = 0; k < 6; ++k) {
        Corners before = z, after = z;
        entry(before, k) -= kStep, entry(after, k) += kStep;
        const double slope = (value_at(density.terms, after) - value_at(density.terms, before)) / (2 * kStep);
        const double scale = 1 + std::abs(slope);
        CHECK(std::abs(entry(gradient, k) - slope) < 1e-5 * scale);
        Corners g0 = gradient_at(density.terms, before), g1 = gradient_at(density.terms, after);
        for (int i = 0; i < 6; ++i) {
          const double difference = (entry(g1, i) - entry(g0, i)) / (2 * kStep);
          const double exact = entry(hessian[i / 2][k / 2], i % 2, k % 2);
          CHECK(std::abs(exact - difference) < 1e-4 * (1 + std::abs(exact)));
        }
      }
    }
  }
}

TEST_CASE("isotropic: values, gradients and Hessians are those of automatic differentiation") {
  std::mt19937 random(6);
  for (const Density& density : kDensities) {
    CAPTURE(density.name);
    for (int trial = 0; trial < 100; ++trial) {
      const Corners z = random_corners(random, !density.finite);
      const CornerWeights a = corner_weights(kFrame);
      const Wirtinger j = wirtinger(a, z);
      const IsotropicTerms terms = density.terms(j);
      Corners gradient = corner_gradient(a, j, terms);
      const auto hessian = corner_hessian(a, j, terms);
      const Jet<6> twin = twin_of(density, z);
      CHECK(terms.value == doctest::Approx(twin.value).epsilon(1e-10));
      for (int i = 0; i < 6; ++i) {
        CHECK(std::abs(entry(gradient, i) - twin.gradient[i]) < 1e-9 * (1 + std::abs(twin.gradient[i])));
        for (int k = 0; k < 6; ++k) {
          const double exact = entry(hessian[i / 2][k / 2], i % 2, k % 2);
          CHECK(std::abs(exact - twin.hessian[i][k]) < 1e-8 * (1 + std::abs(twin.hessian[i][k])));
        }
      }
    }
  }
}

TEST_CASE(
    "isotropic: a projection has no negative curvature, is its own, and leaves convex densities alone") {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const Density& density : kDensities) {
    CAPTURE(density.name);
    for (int trial = 0; trial < 100; ++trial) {
      const Corners z = random_corners(random, !density.finite);
      const CornerWeights a = corner_weights(kFrame);
      const Wirtinger j = wirtinger(a, z);
      const IsotropicTerms exact = density.terms(j), once = projected(exact), twice = projected(once);
      const double scale = 1 + std::abs(exact.pp) + std::abs(exact.qq);
      CHECK(std::abs(twice.pp - once.pp) + std::abs(twice.pq - once.pq) + std::abs(twice.qq - once.qq) <
            1e-12 * scale);
      const auto hessian = corner_hessian(a, j, once), before = corner_hessian(a, j, exact);
      for (int direction = 0; direction < 20; ++direction) {
        Corners x;
        for (int i = 0; i < 6; ++i) entry(x, i) = normal(random);
        CHECK(curvature(hessian, x) > -1e-9 * scale);
        CHECK(curvature(hessian, x) > curvature(before, x) - 1e-9 * scale);  // clamped upwards
      }
    }
  }
  const IsotropicTerms convex{.across_p = 1, .across_q = 2, .pp = 2, .pq = -1, .qq = 1};
  CHECK(projected(convex).pp == 2);
  CHECK(projected(convex).pq == -1);
  const IsotropicTerms concave{.across_p = -1, .across_q = 2, .pp = -2, .pq = 1, .qq = -1};
  CHECK(projected(concave).pp == 0);
  CHECK(projected(concave).across_p == 0);
  // Eigenvalues 3 and -1 of [[1, 2], [2, 1]]: what is left is 3/2 of the ones.
  const IsotropicTerms saddle = projected({.pp = 1, .pq = 2, .qq = 1});
  CHECK(saddle.pp == doctest::Approx(1.5));
  CHECK(saddle.pq == doctest::Approx(1.5));
}

TEST_CASE("isotropic: with twice the determinant ARAP is convex down to |p| = 1/2") {
  std::mt19937 random(7);
  int compressed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Wirtinger j = wirtinger(corner_weights(kFrame), random_corners(random, false));
    const IsotropicTerms terms = plus_determinant(arap_terms(j), j, 2), nearest = projected(terms);
    const double p = norm(j.p);
    CHECK(terms.value == doctest::Approx(4 * p * p - 4 * p + 2));
    if (p < 1) compressed += p >= 0.5;
    CHECK((nearest.across_p == terms.across_p && nearest.pp == terms.pp && nearest.qq == terms.qq) ==
          (p >= 0.5));
  }
  CHECK(compressed > 20);
}

TEST_CASE("isotropic: rotations change no density") {
  std::mt19937 random(5);
  for (const Density& density : kDensities) {
    const Corners z = random_corners(random, true);
    Corners turned;
    for (int i = 0; i < 3; ++i) turned[i] = multiply(unit(0.7), z[i]) + Vec2{3, -2};
    CHECK(value_at(density.terms, turned) == doctest::Approx(value_at(density.terms, z)).epsilon(1e-12));
  }
}

TEST_CASE("isotropic: densities with a wall are infinite from the wall on, the untangling one is not") {
  const Corners flipped{Vec2{0, 0}, {0, 1}, {1, 0}}, flat{Vec2{0, 0}, {1, 0}, {2, 0}};
  for (const Corners& z : {flipped, flat}) {
    CHECK(value_at(kDensities[1].terms, z) == kInfinity);
    CHECK(value_at(kDensities[2].terms, z) == kInfinity);
    CHECK(std::isfinite(value_at(kDensities[3].terms, z)));
  }
  CHECK(untangling_chi(-1, 1e-9) == doctest::Approx(2.5e-19).epsilon(1e-9));
  CHECK(untangling_chi(2, 0) == 2);
}

TEST_CASE("isotropic: the first flip is where the orientation changes, and no earlier") {
  std::mt19937 random(6);
  int found = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Corners z = random_corners(random, true), dz = random_corners(random, false);
    const double t = first_flip(z, dz);
    const auto side = [&](double at) {
      return orient2(z[0] + at * dz[0], z[1] + at * dz[1], z[2] + at * dz[2]);
    };
    const double end = std::isfinite(t) ? t : 100;
    for (int k = 0; k < 50; ++k) CHECK(side(end * (1 - 1e-9) * k / 50) > 0);
    if (!std::isfinite(t)) continue;
    ++found;
    CHECK(side(t * (1 + 1e-7)) <= 0);
  }
  CHECK(found > 100);
  const Corners z{Vec2{0, 0}, {1, 0}, {0, 1}};
  CHECK(first_flip(z, {Vec2{1, 1}, {1, 1}, {1, 1}}) == kInfinity);  // moved
  CHECK(first_flip(z, z) == kInfinity);                             // grown
  CHECK(first_flip(z, {-z[0], -z[1], -z[2]}) == doctest::Approx(1));
}
