#include "kernels/local/proxy.hpp"

#include <doctest/doctest.h>

#include "kernels/intrinsic/cotangents.hpp"
#include "kernels/local/distortion.hpp"
#include "kernels/local/jacobians.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

struct Case {
  RestFrame frame;
  std::array<Vec2, 3> z;
  Cotangents cot;
};

Case random_case(shapes::Random& random) {
  const auto point = [&] { return Vec3{random.uniform(), random.uniform(), random.uniform()}; };
  Case c{.frame = rest_frame(point(), point(), point()), .z = {}, .cot = {}};
  for (Vec2& z : c.z) z = {random.uniform(), random.uniform()};
  c.cot = cotangents(c.frame);
  return c;
}

double arap_energy(const Case& c) {
  return proxy_forces(c.z, c.cot.at.data(), c.frame, closest_rotation(c.z, c.cot.at.data(), c.frame)).energy;
}

}  // namespace

TEST_CASE("proxy: its energy is area times the squared distance of the Jacobian to the closest rotation") {
  shapes::Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const Case c = random_case(random);
    const SingularValues sigma = singular_values(jacobian(c.frame, c.z[0], c.z[1], c.z[2]));
    CHECK(arap_energy(c) == Approx(area(c.frame) * arap(sigma)).epsilon(1e-9));
  }
}

TEST_CASE("proxy: no rotation is closer than the closest one") {
  shapes::Random random(2);
  for (int k = 0; k < 200; ++k) {
    const Case c = random_case(random);
    const double least = arap_energy(c);
    for (int i = 0; i < 64; ++i) {
      CHECK(proxy_forces(c.z, c.cot.at.data(), c.frame, unit(2 * kPi * i / 64)).energy >=
            least * (1 - 1e-12));
    }
  }
}

TEST_CASE("proxy: forces are half the gradient by finite differences, and sum to zero") {
  shapes::Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Case c = random_case(random);
    const double* cot = c.cot.at.data();
    const auto forces = proxy_forces(c.z, cot, c.frame, closest_rotation(c.z, cot, c.frame)).force;
    const Vec2 total = forces[0] + forces[1] + forces[2];
    CHECK(norm(total) < 1e-12 * (1 + norm(forces[0])));
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const auto moved = [&](Vec2 by) {
        Case other = c;
        other.z[i] += by;
        return arap_energy(other);
      };
      const Vec2 slope{(moved({kStep, 0}) - moved({-kStep, 0})) / (2 * kStep),
                       (moved({0, kStep}) - moved({0, -kStep})) / (2 * kStep)};
      CHECK(norm(slope - 2 * forces[i]) < 1e-5 * (1 + norm(slope)));
    }
  }
}

TEST_CASE("proxy: the true Hessian is half the second derivative by finite differences of the forces") {
  shapes::Random random(6);
  for (int k = 0; k < 200; ++k) {
    const Case c = random_case(random);
    const double* cot = c.cot.at.data();
    const auto hessian = proxy_hessian(c.z, cot, c.frame, Convexity::True);
    const auto forces_at = [&](int corner, Vec2 by) {
      auto z = c.z;
      z[corner] += by;
      return proxy_forces(z, cot, c.frame, closest_rotation(z, cot, c.frame)).force;
    };
    constexpr double kStep = 1e-6;
    double scale = 0;
    for (const auto& row : hessian) {
      for (const Mat2& block : row) scale = std::max(scale, squared_norm(block));
    }
    for (int j = 0; j < 3; ++j) {
      const auto right = forces_at(j, {kStep, 0}), left = forces_at(j, {-kStep, 0});
      const auto up = forces_at(j, {0, kStep}), down = forces_at(j, {0, -kStep});
      for (int i = 0; i < 3; ++i) {
        const Vec2 du = (0.5 / kStep) * (right[i] - left[i]), dv = (0.5 / kStep) * (up[i] - down[i]);
        const Mat2& block = hessian[i][j];
        const Mat2 difference{block.m00 - du.x, block.m01 - dv.x, block.m10 - du.y, block.m11 - dv.y};
        CHECK(squared_norm(difference) < 1e-6 * scale);
      }
    }
  }
}

TEST_CASE(
    "proxy: the projected Hessian is positive semidefinite, and the true one where nothing is compressed") {
  shapes::Random random(7);
  for (int k = 0; k < 500; ++k) {
    Case c = random_case(random);
    const double* cot = c.cot.at.data();
    const auto projected = proxy_hessian(c.z, cot, c.frame, Convexity::Projected);
    for (int trial = 0; trial < 20; ++trial) {
      std::array<Vec2, 3> d;
      for (Vec2& x : d) x = {random.uniform() - 0.5, random.uniform() - 0.5};
      double form = 0, size = 0;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const Mat2& b = projected[i][j];
          form += d[i].x * (b.m00 * d[j].x + b.m01 * d[j].y) + d[i].y * (b.m10 * d[j].x + b.m11 * d[j].y);
          size = std::max(size, squared_norm(b));
        }
      }
      CHECK(form > -1e-12 * std::sqrt(size));
    }
    for (Vec2& z : c.z) z = 100.0 * z;
    CHECK(proxy_hessian(c.z, cot, c.frame, Convexity::Projected)[0][1].m01 ==
          proxy_hessian(c.z, cot, c.frame, Convexity::True)[0][1].m01);
  }
}

TEST_CASE("proxy: an isometric image has no energy and no force, for a needle too") {
  for (const double height : {0.7, 1e-7}) {
    const RestFrame frame{1, 0.4, height};
    const Vec2 turn = unit(0.8);
    const std::array<Vec2, 3> z = {Vec2{2, 1}, Vec2{2, 1} + multiply(turn, {1, 0}),
                                   Vec2{2, 1} + multiply(turn, {0.4, height})};
    const Cotangents cot = cotangents(frame);
    const auto f = proxy_forces(z, cot.at.data(), frame, closest_rotation(z, cot.at.data(), frame));
    CHECK(f.energy < 1e-16);  // rounding of the image times the largest weight
    for (const Vec2 force : f.force) CHECK(norm(force) < 1e-8);
  }
}

TEST_CASE("svd2: signed singular values give norm and determinant of the matrix") {
  shapes::Random random(4);
  for (int k = 0; k < 1000; ++k) {
    const Mat2 m{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5,
                 random.uniform() - 0.5};
    const SingularValues s = singular_values(m);
    CHECK(s.sigma_max >= std::abs(s.sigma_min));
    CHECK(s.sigma_max * s.sigma_min == Approx(determinant(m)));
    CHECK(s.sigma_max * s.sigma_max + s.sigma_min * s.sigma_min == Approx(squared_norm(m)));
  }
}

TEST_CASE("distortion: the identity costs 0 and 4, a mirror image costs 4 and infinity") {
  CHECK(arap({1, 1}) == 0);
  CHECK(symmetric_dirichlet({1, 1}) == 4);
  CHECK(arap({1, -1}) == 4);
  CHECK(symmetric_dirichlet({1, -1}) == kInfinity);
}
