#include "kernels/local/contact.hpp"

#include <doctest/doctest.h>

#include <random>

#include "tests/support/jet.hpp"

using namespace planish;
using planish::tests::Jet;

namespace {

using Corners = std::array<Vec2, 3>;
using Blocks = std::array<std::array<Mat2, 3>, 3>;

Corners random_corners(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  Corners z;
  do {
    for (Vec2& p : z) p = {coordinate(random), coordinate(random)};
  } while (norm(z[2] - z[1]) < 0.3 || segment_distance(z[0], z[1], z[2]).distance < 0.1);
  return z;
}

/// The distance by its definition, over the six coordinates.
Jet<6> distance_twin(const Corners& z) {
  std::array<Jet<6>, 6> x;
  for (int i = 0; i < 6; ++i) x[i] = Jet<6>::variable(i % 2 == 0 ? z[i / 2].x : z[i / 2].y, i);
  const Vec2 edge = z[2] - z[1];
  const double s = dot(edge, z[0] - z[1]) / dot(edge, edge);
  if (s <= 0 || s >= 1) {
    const int end = s <= 0 ? 2 : 4;
    const Jet<6> dx = x[0] - x[end], dy = x[1] - x[end + 1];
    return root(dx * dx + dy * dy);
  }
  const Jet<6> ex = x[4] - x[2], ey = x[5] - x[3], rx = x[0] - x[2], ry = x[1] - x[3];
  const Jet<6> area = ex * ry - ey * rx;
  return root(area * area * inverse(ex * ex + ey * ey));
}

double entry(const Blocks& blocks, int i, int k) {
  const Mat2& m = blocks[i / 2][k / 2];
  return i % 2 == 0 ? (k % 2 == 0 ? m.m00 : m.m01) : (k % 2 == 0 ? m.m10 : m.m11);
}

double curvature(const Blocks& blocks, const std::array<double, 6>& x) {
  double sum = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 6; ++k) sum += x[i] * entry(blocks, i, k) * x[k];
  }
  return sum;
}

}  // namespace

TEST_CASE("contact: distances, gradients and Hessians are those of automatic differentiation") {
  std::mt19937 random(1);
  int at_ends = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Corners z = random_corners(random);
    const SegmentDistance d = segment_distance(z[0], z[1], z[2]);
    const Jet<6> twin = distance_twin(z);
    at_ends += d.at_end;
    CHECK(d.distance == doctest::Approx(twin.value).epsilon(1e-12));
    for (int i = 0; i < 6; ++i) {
      const double along = i % 2 == 0 ? d.away.x : d.away.y;
      CHECK(std::abs(d.share[i / 2] * along - twin.gradient[i]) < 1e-12);
    }
    const double slope = -0.7, bend = 1.3;
    const Blocks hessian = contact_hessian(d, slope, bend, 0);
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 6; ++k) {
        const double expected = slope * twin.hessian[i][k] + bend * twin.gradient[i] * twin.gradient[k];
        CHECK(std::abs(entry(hessian, i, k) - expected) < 1e-11 * (1 + std::abs(expected)));
      }
    }
  }
  CHECK(at_ends > 20);
  CHECK(at_ends < 180);
}

TEST_CASE("contact: a projected Hessian has no negative curvature, and no less than the exact one") {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    const Corners z = random_corners(random);
    const SegmentDistance d = segment_distance(z[0], z[1], z[2]);
    const Blocks exact = contact_hessian(d, -2, 0.5, 0), half = contact_hessian(d, -2, 0.5, 0.5),
                 projected = contact_hessian(d, -2, 0.5, 1);
    for (int direction = 0; direction < 20; ++direction) {
      std::array<double, 6> x;
      for (double& value : x) value = normal(random);
      CHECK(curvature(projected, x) > -1e-10);
      CHECK(curvature(projected, x) > curvature(exact, x) - 1e-10);
      CHECK(curvature(half, x) ==
            doctest::Approx(0.5 * (curvature(exact, x) + curvature(projected, x))).epsilon(1e-9));
    }
  }
}

TEST_CASE("contact: a point meets a segment where both lie on a line for the first time, within its ends") {
  const Vec2 still{0, 0};
  const Corners above{Vec2{0.5, 2}, {0, 0}, {1, 0}};
  CHECK(first_contact(above, {Vec2{0, -1}, still, still}) == doctest::Approx(2));
  CHECK(first_contact(above, {Vec2{1, -1}, still, still}) == kInfinity);  // past the end
  CHECK(first_contact(above, {Vec2{0, 1}, still, still}) == kInfinity);
  CHECK(first_contact(above, {still, {0, 1}, {0, 1}}) == doctest::Approx(2));
  CHECK(first_contact({Vec2{1, 2}, {0, 0}, {1, 0}}, {Vec2{0, -1}, still, still}) ==
        doctest::Approx(2));  // exactly on the end
}

TEST_CASE("contact: until the first contact a point keeps its distance, and there it has none") {
  std::mt19937 random(3);
  int met = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Corners z = random_corners(random), step = random_corners(random);
    const double t = first_contact(z, step);
    const auto at = [&](double share) {
      Corners moved = z;
      for (int i = 0; i < 3; ++i) moved[i] += share * step[i];
      return segment_distance(moved[0], moved[1], moved[2]).distance;
    };
    for (int k = 0; k <= 100; ++k) CHECK(at(0.999 * std::min(t, 10.0) * k / 100) > 0);
    if (t > 10) continue;
    ++met;
    CHECK(at(t) < 1e-9);
  }
  CHECK(met > 50);
}
