#include "engine/solve/quasi_newton.hpp"

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

constexpr Index kSize = 12;  // 24 unknowns

std::vector<Vec2> from(const Eigen::VectorXd& x) {
  std::vector<Vec2> z(kSize);
  for (Index i = 0; i < kSize; ++i) z[i] = {x[2 * i], x[2 * i + 1]};
  return z;
}

Eigen::MatrixXd random_definite(shapes::Random& random) {
  Eigen::MatrixXd a(2 * kSize, 2 * kSize);
  for (auto& x : a.reshaped()) x = random.uniform() - 0.5;
  return a * a.transpose() + 0.5 * Eigen::MatrixXd::Identity(2 * kSize, 2 * kSize);
}

}  // namespace

TEST_CASE("quasi-Newton: the direction is that of the inverse Hessian formed by explicit BFGS updates") {
  shapes::Random random(4);
  const Eigen::MatrixXd laplacian = random_definite(random), hessian = random_definite(random);
  const Eigen::MatrixXd inverse = laplacian.inverse();
  const auto random_vector = [&] {
    Eigen::VectorXd x(2 * kSize);
    for (auto& value : x) value = random.uniform() - 0.5;
    return x;
  };
  const Exec exec(2);
  for (const int count : {0, 1, 2, 3, 5}) {  // more pairs than the memory of 3: the oldest are forgotten
    VectorPool pool;
    QuasiNewton quasi_newton(exec, 3, pool);
    std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> pairs;
    Eigen::VectorXd position = random_vector();  // force: hessian * position
    for (int k = 0; k < count; ++k) {
      const Eigen::VectorXd next = random_vector();
      const Eigen::VectorXd s = next - position, y = hessian * s;
      const auto [p0, p1] = std::pair{from(position), from(next)};
      const auto [f0, f1] = std::pair{from(hessian * position), from(hessian * next)};
      const auto [d0, d1] = std::pair{from(-inverse * hessian * position), from(-inverse * hessian * next)};
      quasi_newton.learn({p0, f0, d0}, {p1, f1, d1});
      position = next;
      pairs.emplace_back(s, y);
      if (pairs.size() > 3) pairs.erase(pairs.begin());
    }
    const auto& [s_last, y_last] = pairs.empty() ? std::pair{random_vector(), random_vector()} : pairs.back();
    const double scale = pairs.empty() ? 1 : s_last.dot(y_last) / y_last.dot(inverse * y_last);
    Eigen::MatrixXd h = scale * inverse;
    const auto identity = Eigen::MatrixXd::Identity(2 * kSize, 2 * kSize);
    for (const auto& [s, y] : pairs) {
      const double rho = 1 / s.dot(y);
      h = (identity - rho * s * y.transpose()) * h * (identity - rho * y * s.transpose()) +
          rho * s * s.transpose();
    }
    const Eigen::VectorXd force = hessian * position, d = -inverse * force, expected = -h * force;
    std::vector<Vec2> direction(kSize);
    const double slope = quasi_newton.direction(from(d), force.dot(d), direction);
    const auto expected_direction = from(expected);
    for (Index i = 0; i < kSize; ++i) CHECK(norm(direction[i] - expected_direction[i]) < 1e-9);
    CHECK(slope == doctest::Approx(force.dot(expected)).epsilon(1e-9));
  }
}

TEST_CASE("quasi-Newton: a step without positive curvature is not learnt from") {
  const Exec exec(1);
  VectorPool pool;
  QuasiNewton quasi_newton(exec, 3, pool);
  const std::vector<Vec2> p(kSize), q(kSize, {1, 0}), f(kSize), g(kSize, {-1, 0}), d(kSize, {0, 2});
  quasi_newton.learn({p, f, f}, {q, g, d});
  std::vector<Vec2> direction(kSize);
  CHECK(quasi_newton.direction(d, -3, direction) == -3);
  CHECK(direction == d);
}
