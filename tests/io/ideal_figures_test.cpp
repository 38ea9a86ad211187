#include "io/ideal_figures.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/shapes.hpp"

namespace planish {
namespace {

std::vector<Vec2> arc(Vec2 centre, double radius, double from, double sweep, int n, double noise = 0) {
  shapes::Random random(7);
  std::vector<Vec2> point;
  for (int i = 0; i < n; ++i) {
    const double r = radius + noise * (random.uniform() - 0.5);
    point.push_back(centre + r * unit(from + sweep * i / (n - 1)));
  }
  return point;
}

double sum_of_squares(In<Vec2> point, const FittedCircle& circle) {
  double sum = 0;
  for (const Vec2 p : point) sum += std::pow(norm(p - circle.centre) - circle.radius, 2);
  return sum;
}

double length_of(In<Vec2> line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += norm(line[i] - line[i - 1]);
  return length;
}

constexpr PixelBox kBox{{0, 0}, {100, 60}};

TEST_CASE("ideal figures: a line through points at equal distances on both sides is their middle") {
  for (const double angle : {0.0, 0.4, kPi / 2, 2.8}) {
    const Vec2 along = unit(angle), aside{-along.y, along.x}, start{30, -70};
    std::vector<Vec2> point;
    for (int i = 0; i < 40; ++i) point.push_back(start + 1.0 * i * along + (i % 4 < 2 ? 0.1 : -0.1) * aside);
    const auto line = fit_line(point);
    REQUIRE(line);
    CHECK(std::abs(cross(line->direction, along)) < 1e-3);
    CHECK(norm(line->direction) == doctest::Approx(1));
    CHECK(std::abs(dot(line->point - start, aside)) < 1e-9);
    CHECK(line->last - line->first == doctest::Approx(39).epsilon(1e-4));
  }
}

TEST_CASE("ideal figures: one point has no line, points of a line have no circle") {
  CHECK_FALSE(fit_line({}));
  CHECK_FALSE(fit_line(std::vector<Vec2>(5, Vec2{3, 4})));
  CHECK_FALSE(fit_circle(std::vector<Vec2>(5, Vec2{3, 4})));
  CHECK_FALSE(fit_circle(std::vector<Vec2>{{0, 0}, {1, 1}}));
  CHECK_FALSE(fit_circle(std::vector<Vec2>{{0, 0}, {1, 1}, {2, 2}, {7, 7}}));
  CHECK_FALSE(fit_circle(std::vector<Vec2>{{0, 0}, {1e3, 1e-3}, {2e3, 0}}));  // a radius of 5 10^8
}

TEST_CASE("ideal figures: points of a circle or an arc give it back") {
  for (const double sweep : {0.1, 0.5, 2.0, 6.0}) {
    const auto circle = fit_circle(arc({250, -40}, 90, 1, sweep, 30));
    REQUIRE(circle);
    CHECK(norm(circle->centre - Vec2{250, -40}) < 1e-6);
    CHECK(circle->radius == doctest::Approx(90).epsilon(1e-8));
  }
}

TEST_CASE("ideal figures: no circle near the fitted one is nearer to the points") {
  for (const double sweep : {1.0, 3.0, 6.2}) {
    const std::vector<Vec2> point = arc({10, 20}, 50, 0.3, sweep, 60, 4);
    const auto circle = fit_circle(point);
    REQUIRE(circle);
    const double least = sum_of_squares(point, *circle);
    CHECK(least > 1);
    for (const double step : {-0.01, 0.01}) {
      CHECK(sum_of_squares(point, {circle->centre + Vec2{step, 0}, circle->radius}) > least);
      CHECK(sum_of_squares(point, {circle->centre + Vec2{0, step}, circle->radius}) > least);
      CHECK(sum_of_squares(point, {circle->centre, circle->radius + step}) > least);
    }
  }
}

TEST_CASE("ideal figures: a line reaches beyond its points, and ends at the box") {
  const FittedLine level{.point = {50, 30}, .direction = {1, 0}, .first = -20, .last = 10};
  CHECK(part_inside(level, 5, kBox) == std::vector<Vec2>{{25, 30}, {65, 30}});
  CHECK(part_inside(level, 45, kBox) == std::vector<Vec2>{{0, 30}, {100, 30}});
  const FittedLine upright{.point = {50, 30}, .direction = {0, 1}, .first = -20, .last = 10};
  CHECK(part_inside(upright, 45, kBox) == std::vector<Vec2>{{50, 0}, {50, 60}});
  CHECK(part_inside({.point = {50, 61}, .direction = {1, 0}, .first = -20, .last = 10}, 5, kBox).empty());
  CHECK(part_inside({.point = {-50, 30}, .direction = {1, 0}, .first = -20, .last = 10}, 5, kBox).empty());
}

TEST_CASE("ideal figures: a circle is cut to the box") {
  const auto whole = parts_inside({{50, 30}, 20}, 0.5, kBox);
  REQUIRE(whole.size() == 1);
  CHECK(norm(whole[0].front() - whole[0].back()) < 1e-9);
  CHECK(length_of(whole[0]) == doctest::Approx(2 * kPi * 20).epsilon(1e-3));
  const auto quarter = parts_inside({{0, 0}, 40}, 0.5, kBox);
  REQUIRE(quarter.size() == 1);
  CHECK(length_of(quarter[0]) == doctest::Approx(kPi / 2 * 40).epsilon(1e-3));
  const auto two_sides = parts_inside({{50, 30}, 40}, 0.5, kBox);  // above and below are cut off
  double length = 0;
  for (const auto& part : two_sides) {
    length += length_of(part);
    for (const Vec2 p : part) {
      CHECK(p.y > -1e-9);
      CHECK(p.y < 60 + 1e-9);
      CHECK(norm(p - Vec2{50, 30}) == doctest::Approx(40));
    }
  }
  CHECK(length == doctest::Approx(4 * std::asin(0.75) * 40).epsilon(1e-3));
  CHECK(parts_inside({{50, 30}, 400}, 0.5, kBox).empty());
  CHECK(parts_inside({{500, 30}, 40}, 0.5, kBox).empty());
  const auto nearly_straight = parts_inside({{50, 1e6 + 30}, 1e6}, 0.5, kBox);
  REQUIRE(nearly_straight.size() == 1);
  CHECK(length_of(nearly_straight[0]) == doctest::Approx(100).epsilon(1e-3));
}

}  // namespace
}  // namespace planish
