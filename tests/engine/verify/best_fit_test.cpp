#include "engine/verify/best_fit.hpp"

#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

/// n points of an arc about (3, -2), from angle 0.4 on.
std::vector<Vec2> arc(Index n, double radius, double sweep) {
  std::vector<Vec2> points;
  for (Index i = 0; i < n; ++i) points.push_back(Vec2{3, -2} + radius * unit(0.4 + sweep * i / (n - 1)));
  return points;
}

std::vector<Vec2> scattered(Index n) {
  shapes::Random random(5);
  std::vector<Vec2> points;
  for (Index i = 0; i < n; ++i) points.push_back({random.uniform(), random.uniform()});
  return points;
}

}  // namespace

TEST_CASE("best fit: a line runs from the first point to the last, and no other is nearer") {
  const std::vector<Vec2> points = {{4, 2.1}, {3, 1.4}, {2, 1.1}, {1, 0.4}};
  const fit::Line line = fit::line_through(points);
  CHECK(line.direction.x < 0);
  CHECK(norm(line.direction) == Approx(1));
  const auto squared = [&](const fit::Line& l) {
    double sum = 0;
    for (const Vec2 p : points) sum += l.distance(p) * l.distance(p);
    return sum;
  };
  for (const double turn : {-1e-3, 1e-3})
    CHECK(squared({line.centre, multiply(line.direction, unit(turn))}) > squared(line));
  CHECK(line.along(points[0]) < line.along(points[3]));
}

TEST_CASE("best fit: points of a circle give it back, short arcs too") {
  for (const double sweep : {0.05, 1.0, 5.0}) {
    const auto circle = fit::circle_through(arc(30, 2, sweep));
    REQUIRE(circle);
    CHECK(circle->radius == Approx(2).epsilon(1e-9));
    CHECK(norm(circle->centre - Vec2{3, -2}) < 1e-8);
  }
  CHECK(!fit::circle_through(std::vector<Vec2>{{0, 0}, {1, 1}, {2, 2}}));
}

TEST_CASE("best fit: a circle of a given radius keeps it, and shows points that need another") {
  const std::vector<Vec2> points = arc(30, 2, 5);
  const auto circle = fit::circle_through(points, 2.5);
  REQUIRE(circle);
  CHECK(circle->radius == 2.5);
  double farthest = 0;
  for (const Vec2 p : points) farthest = std::max(farthest, circle->distance(p));
  CHECK(farthest > 0.4);
}

TEST_CASE("best fit: a similarity is found to rounding, a mirror image is not") {
  const std::vector<Vec2> shape = scattered(20);
  std::vector<Vec2> image, mirrored;
  for (const Vec2 t : shape) {
    image.push_back(Vec2{7, 8} + multiply(3 * unit(2), t));
    mirrored.push_back(conjugate(t));
  }
  const auto farthest = [&](const fit::Pose& pose, In<Vec2> target) {
    double far = 0;
    for (std::size_t i = 0; i < shape.size(); ++i)
      far = std::max(far, norm(pose.place(shape[i]) - target[i]));
    return far;
  };
  const fit::Pose pose = fit::best_pose(shape, image);
  CHECK(norm(pose.turn) == Approx(3));
  CHECK(argument(pose.turn) == Approx(2));
  CHECK(farthest(pose, image) < 1e-14);
  CHECK(norm(fit::best_pose(shape, image, 1.0).turn) == Approx(1));
  CHECK(farthest(fit::best_pose(shape, mirrored), mirrored) > 0.1);
}

TEST_CASE("best fit: points of a plane are seen without change, and their heights are over it") {
  std::vector<Vec3> points;
  for (const Vec2 p : scattered(20)) points.push_back({p.x, 2 * p.y, p.x + 5});
  const fit::Projection seen = fit::project(points);
  CHECK(std::abs(std::abs(dot(seen.normal, Vec3{-1, 0, 1})) - std::sqrt(2)) < 1e-12);
  CHECK(seen.moment[0] >= seen.moment[1]);
  CHECK(std::abs(seen.moment[2]) < 1e-14);
  for (std::size_t i = 1; i < points.size(); ++i) {
    CHECK(norm(seen.image[i] - seen.image[0]) == Approx(norm(points[i] - points[0])));
    CHECK(std::abs(seen.height[i]) < 1e-12);
  }
}

TEST_CASE("best fit: an arc of given chords and sweep has their radius") {
  std::vector<double> chord;
  for (const double angle : {0.2, 0.5, 0.3}) chord.push_back(2 * 7 * std::sin(angle / 2));
  CHECK(fit::arc_radius(chord, 1.0) == Approx(7));
  CHECK(fit::sweep_about({3, -2}, arc(9, 2, 4.5)) == Approx(4.5));
}
