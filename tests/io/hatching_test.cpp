#include "io/hatching.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace planish {
namespace {

using Loops = std::vector<std::vector<Vec2>>;

std::vector<Vec2> square(double low, double high) {
  return {{low, low}, {high, low}, {high, high}, {low, high}};
}

/// Length of the lines times their spacing.
double covered(In<Vec2> segments, double spacing) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < segments.size(); i += 2) length += norm(segments[i + 1] - segments[i]);
  return length * spacing;
}

TEST_CASE("hatching: lines cover the area, and spare a hole") {
  for (const double angle : {0.0, 0.3, kPi / 4, kPi / 2, 2.5}) {
    const Vec2 direction = unit(angle);
    CHECK(covered(hatch(Loops{square(0, 100)}, direction, 0.5), 0.5) == doctest::Approx(1e4).epsilon(0.01));
    const std::vector<Vec2> lines = hatch(Loops{square(0, 100), square(30, 60)}, direction, 0.5);
    CHECK(covered(lines, 0.5) == doctest::Approx(1e4 - 900).epsilon(0.01));
    for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
      const Vec2 middle = 0.5 * (lines[i] + lines[i + 1]);
      CHECK_FALSE((std::abs(middle.x - 45) < 14.9 && std::abs(middle.y - 45) < 14.9));
      CHECK(std::abs(cross(lines[i + 1] - lines[i], direction)) < 1e-9);
    }
  }
}

TEST_CASE("hatching: lines that meet corners and sides end inside") {
  // Through both corners of the diagonal and along two sides.
  for (const Vec2 direction : {Vec2{1, 0}, Vec2{0, 1}, unit(kPi / 4), unit(-kPi / 4)}) {
    for (const double spacing : {1.0, 10.0, 100.0, std::sqrt(0.5)}) {
      const std::vector<Vec2> lines = hatch(Loops{square(0, 100)}, direction, spacing);
      CHECK(lines.size() % 2 == 0);
      for (const Vec2 p : lines) {
        CHECK(std::abs(p.x - 50) < 50 + 1e-9);
        CHECK(std::abs(p.y - 50) < 50 + 1e-9);
      }
    }
  }
}

TEST_CASE("hatching: nothing has no lines") {
  CHECK(hatch({}, {1, 0}, 1).empty());
  CHECK(hatch(Loops{{}, {{3, 3}}, {{1, 1}, {5, 5}}}, {1, 0}, 10).empty());
}

}  // namespace
}  // namespace planish
