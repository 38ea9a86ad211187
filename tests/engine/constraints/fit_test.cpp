#include "engine/constraints/fit.hpp"

#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

std::vector<Vec2> scattered(std::size_t n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Vec2> point(n);
  for (Vec2& p : point) p = {random.uniform() - 0.3, 2 * random.uniform()};
  return point;
}

double misfit(In<Vec2> shape, In<Vec2> point, const Placement& at) {
  double sum = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vec2 d = at.p + multiply(at.c, shape[i]) - point[i];
    sum += dot(d, d);
  }
  return sum;
}

double circle_misfit(In<Vec2> point, const BestCircle& circle) {
  double sum = 0;
  for (const Vec2 p : point) sum += std::pow(norm(p - circle.centre) - circle.radius, 2);
  return sum;
}

}  // namespace

TEST_CASE("fit plane: points of a tilted plane give its normal, and distances along it stay") {
  const Vec3 a = {2.0 / 3, 2.0 / 3, 1.0 / 3}, b = {-2.0 / 3, 1.0 / 3, 2.0 / 3}, n = cross(a, b);
  std::vector<Vec3> point;
  const std::vector<Vec2> flat = scattered(30, 4);
  for (const Vec2 p : flat) point.push_back(Vec3{10, -3, 5} + p.x * a + p.y * b);
  const FittedPlane plane = fit_plane(point);
  CHECK(std::abs(dot(plane.normal, n)) == doctest::Approx(1).epsilon(1e-13));
  CHECK(norm(cross(plane.first, plane.second) - plane.normal) < 1e-13);
  CHECK(plane.farthest < 1e-14);
  CHECK(plane.spread[0] > plane.spread[1]);
  CHECK(plane.spread[2] < 1e-13);
  for (std::size_t i = 1; i < flat.size(); ++i) {
    CHECK(norm(in_plane(plane, point[i]) - in_plane(plane, point[0])) ==
          doctest::Approx(norm(flat[i] - flat[0])).epsilon(1e-13));
  }
}

TEST_CASE("fit plane: the farthest point of a saddle's rim lies as far as the saddle is high") {
  std::vector<Vec3> point;
  for (int i = 0; i < 64; ++i) {
    const double a = 2 * kPi * i / 64;
    point.push_back({std::cos(a), std::sin(a), 0.1 * std::cos(2 * a)});
  }
  const FittedPlane plane = fit_plane(point);
  CHECK(plane.farthest == doctest::Approx(0.1).epsilon(1e-12));
  CHECK(std::abs(plane.normal.z) == doctest::Approx(1).epsilon(1e-12));
  CHECK(plane.spread[2] == doctest::Approx(std::sqrt(64 * 0.005)).epsilon(1e-12));
}

TEST_CASE("fit plane: turned towards a direction its normal is the part of it across the first axis") {
  const std::vector<Vec3> point = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  FittedPlane plane = fit_plane(point);
  turn_towards(plane, point, {0.5, 0.6, 0.8});
  CHECK(norm(plane.normal - Vec3{0, 0.6, 0.8}) < 1e-13);
  CHECK(norm(cross(plane.first, plane.second) - plane.normal) < 1e-13);
  CHECK(plane.farthest < 1e-13);
}

TEST_CASE("best circle: points of a circle give it back, also from a short arc") {
  for (const double sweep : {6.28, 2.0, 0.3, 0.02}) {
    std::vector<Vec2> point;
    for (int i = 0; i < 20; ++i) point.push_back(Vec2{3, -1} + 2.5 * unit(1 + sweep * i / 19));
    const BestCircle circle = best_circle(point);
    // A short arc sees its centre from afar: errors grow with the inverse sagitta.
    CHECK(circle.radius == doctest::Approx(2.5).epsilon(1e-12 / std::min(1.0, sweep * sweep)));
    CHECK(norm(circle.centre - Vec2{3, -1}) < 1e-11 / std::min(1.0, sweep * sweep));
  }
}

TEST_CASE("best circle: no circle beside it has a smaller sum of squared distances") {
  shapes::Random random(11);
  std::vector<Vec2> point;
  for (int i = 0; i < 40; ++i) point.push_back((1 + 0.2 * random.uniform()) * unit(0.12 * i));
  const BestCircle best = best_circle(point);
  const double least = circle_misfit(point, best);
  for (const double step : {1e-3, 1e-2}) {
    for (int k = 0; k < 6; ++k) {
      BestCircle other = best;
      (k / 2 == 0 ? other.centre.x : k / 2 == 1 ? other.centre.y : other.radius) += k % 2 ? step : -step;
      CHECK(circle_misfit(point, other) > least);
    }
  }
}

TEST_CASE("best circle: points on a line have an infinite radius, nearly straight ones their own") {
  for (int turn = 0; turn < 8; ++turn) {
    for (const double sagitta : {0.0, 1e-15, 1e-5, 1e-3}) {
      std::vector<Vec2> point;
      for (int i = 0; i < 9; ++i) {
        const double x = (i - 4) / 8.0;
        point.push_back(Vec2{1, 2} + multiply(unit(turn), {x, sagitta * (1 - 4 * x * x)}));
      }
      const BestCircle circle = best_circle(point);
      if (sagitta < 1e-12) {
        CHECK(std::isinf(circle.radius));
      } else {
        CHECK(circle.radius == doctest::Approx(0.125 / sagitta).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("best line: its direction is that of points on a line, and the long axis of a cloud") {
  std::vector<Vec2> point;
  for (int i = 0; i < 7; ++i) point.push_back(Vec2{2, 1} + (0.5 * i * i) * unit(2.1));
  CHECK(std::abs(cross(best_line(point).direction, unit(2.1))) < 1e-13);
  const std::vector<Vec2> cross_shape = {{3, 0}, {-3, 0}, {0, 1}, {0, -1}};
  CHECK(std::abs(best_line(cross_shape).direction.y) < 1e-14);
}

TEST_CASE("best placement: a moved, turned and scaled copy is found exactly") {
  const std::vector<Vec2> shape = scattered(12, 5);
  const Vec2 p = {4, -2}, c = 1.7 * unit(2.4);
  std::vector<Vec2> point;
  for (const Vec2 t : shape) point.push_back(p + multiply(c, t));
  const Placement free = best_placement(shape, point, 0);
  CHECK(norm(free.p - p) < 1e-13);
  CHECK(norm(free.c - c) < 1e-13);
  const Placement given = best_placement(shape, point, 0.5);
  CHECK(norm(given.c - 0.5 * unit(2.4)) < 1e-13);
}

TEST_CASE("best placement: of unlike shapes no neighbour fits better, with the scale given and free") {
  const std::vector<Vec2> shape = scattered(9, 6), point = scattered(9, 7);
  const Placement free = best_placement(shape, point, 0), given = best_placement(shape, point, 0.8);
  CHECK(norm(given.c) == doctest::Approx(0.8).epsilon(1e-14));
  for (int k = 0; k < 12; ++k) {
    const Vec2 step = 1e-3 * unit(k);
    CHECK(misfit(shape, point, {free.p + step, free.c}) > misfit(shape, point, free));
    CHECK(misfit(shape, point, {free.p, free.c + step}) > misfit(shape, point, free));
    CHECK(misfit(shape, point, {given.p + step, given.c}) > misfit(shape, point, given));
  }
  for (const double turn : {-1e-3, 1e-3}) {
    const Placement turned{given.p, multiply(unit(turn), given.c)};
    CHECK(misfit(shape, point, turned) > misfit(shape, point, given));
  }
}

TEST_CASE("best placement: a template without extent keeps the scale that it is given") {
  const std::vector<Vec2> shape(3, Vec2{1, 1}), point = {{0, 0}, {1, 0}, {0, 1}};
  const Placement placement = best_placement(shape, point, 0.8);
  CHECK(placement.c == Vec2{0.8, 0});
  CHECK(norm(placement.p + multiply(placement.c, {1, 1}) - Vec2{1.0 / 3, 1.0 / 3}) < 1e-15);
}
