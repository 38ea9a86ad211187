#include "engine/constraints/cyclic_polygon.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// Largest deviation of the edges from their lengths and of the corners from the circle around the origin.
double worst_error(const CyclicPolygon& polygon, In<double> length) {
  double worst = 0;
  for (std::size_t i = 0; i < length.size(); ++i) {
    const Vec2 edge = polygon.corner[(i + 1) % length.size()] - polygon.corner[i];
    worst = std::max(worst, std::abs(norm(edge) - length[i]));
    worst = std::max(worst, std::abs(norm(polygon.corner[i]) - polygon.radius));
  }
  return worst;
}

double doubled_area_of(In<Vec2> corner) {
  double sum = 0;
  for (std::size_t i = 0; i < corner.size(); ++i) sum += cross(corner[i], corner[(i + 1) % corner.size()]);
  return sum;
}

/// Circumradius by the sides.
double circumradius(double a, double b, double c) {
  const double s = 0.5 * (a + b + c);
  return a * b * c / (4 * std::sqrt(s * (s - a) * (s - b) * (s - c)));
}

double worst_arc_edge(const CyclicPolygon& arc, In<double> length) {
  double worst = 0;
  for (std::size_t i = 0; i < length.size(); ++i)
    worst = std::max(worst, std::abs(norm(arc.corner[i + 1] - arc.corner[i]) - length[i]));
  return worst;
}

/// Edges chosen so that the longest is up to 40 times the shortest.
std::vector<double> random_lengths(std::size_t n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<double> length(n);
  for (double& l : length) l = std::pow(40.0, random.uniform());
  return length;
}

}  // namespace

TEST_CASE("cyclic polygon: n equal edges make the regular n-gon, radius l / (2 sin(pi / n))") {
  for (const std::size_t n : {3u, 4u, 5u, 6u, 17u, 1000u}) {
    const std::vector<double> length(n, 0.7);
    const auto polygon = cyclic_polygon(length);
    REQUIRE(polygon);
    CHECK(polygon->radius == doctest::Approx(0.35 / std::sin(kPi / static_cast<double>(n))).epsilon(1e-13));
    CHECK(worst_error(*polygon, length) < 1e-13 * 0.7 * static_cast<double>(n));
    CHECK(doubled_area_of(polygon->corner) > 0);
  }
}

TEST_CASE("cyclic polygon: a triangle's radius is its circumradius, acute, right and obtuse") {
  const double sides[][3] = {{3, 4, 5},        {5, 3, 4},     {1, 1, 1},      {2, 3, 4},   {2, 2, 3.9},
                             {1, 1, 1.999999}, {7, 24, 24.9}, {1, 10, 10.99}, {10, 1, 9.1}};
  for (const auto& s : sides) {
    const auto triangle = cyclic_polygon(s);
    REQUIRE(triangle);
    CHECK(triangle->radius == doctest::Approx(circumradius(s[0], s[1], s[2])).epsilon(1e-9));
    CHECK(worst_error(*triangle, s) < 1e-12 * std::max(1.0, triangle->radius));
  }
}

TEST_CASE("cyclic polygon: the centre lies outside where one edge is nearly as long as the others together") {
  const std::vector<double> length = {1, 1.2, 0.8, 1, 3.9};
  const auto polygon = cyclic_polygon(length);
  REQUIRE(polygon);
  CHECK(worst_error(*polygon, length) < 1e-12);
  // The centre is the origin: it is on the outer side of the longest edge, from corner 4 to corner 0.
  CHECK(cross(polygon->corner[4], polygon->corner[0]) < 0);
  CHECK(doubled_area_of(polygon->corner) > 0);
}

TEST_CASE(
    "cyclic polygon: an edge that is a diameter is found from both sides, where the centre changes sides") {
  // Thales: 3 and 4 over the diameter 5; the length around it puts the centre inside or outside.
  for (const double change : {-1e-6, -1e-12, 0.0, 1e-12, 1e-6}) {
    const std::vector<double> length = {3, 4, 5 + change};
    const auto triangle = cyclic_polygon(length);
    REQUIRE(triangle);
    CHECK(triangle->radius == doctest::Approx(circumradius(3, 4, 5 + change)).epsilon(1e-12));
    CHECK(worst_error(*triangle, length) < 1e-12);
  }
}

TEST_CASE(
    "cyclic polygon: uneven edges in any order have their lengths on one circle, whose radius is the same") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::vector<double> length = random_lengths(3 + seed % 30, seed);
    const double longest = *std::max_element(length.begin(), length.end());
    const double sum = std::accumulate(length.begin(), length.end(), 0.0);
    const auto polygon = cyclic_polygon(length);
    CHECK(polygon.has_value() == (longest < sum - longest));
    if (!polygon) continue;
    CHECK(worst_error(*polygon, length) < 1e-12 * std::max(sum, polygon->radius));
    std::sort(length.begin(), length.end());
    const auto sorted = cyclic_polygon(length);
    REQUIRE(sorted);
    CHECK(sorted->radius == doctest::Approx(polygon->radius).epsilon(1e-12));
  }
}

TEST_CASE("cyclic polygon: scaled edges give the scaled polygon") {
  const std::vector<double> length = {1, 2, 0.5, 2.5, 1.1};
  std::vector<double> scaled = length;
  for (double& l : scaled) l *= 1e-9;
  const auto polygon = cyclic_polygon(length), small = cyclic_polygon(scaled);
  REQUIRE(polygon);
  REQUIRE(small);
  for (std::size_t i = 0; i < length.size(); ++i)
    CHECK(norm(1e9 * small->corner[i] - polygon->corner[i]) < 1e-12);
}

TEST_CASE(
    "cyclic polygon: none where an edge is as long as all others together, or with fewer than 3 edges") {
  CHECK_FALSE(cyclic_polygon(std::vector<double>{1, 2, 3}));
  CHECK_FALSE(cyclic_polygon(std::vector<double>{1, 1, 1, 3.5}));
  CHECK_FALSE(cyclic_polygon(std::vector<double>{1, 1}));
}

TEST_CASE(
    "cyclic polygon: corner angles follow the paper's formula, to the square of the edges over the whole") {
  // beta at the corner between edges i and i + 1 is pi (1 - (l_i + l_(i + 1)) / L) in the limit of small edges: the
  // half sectors asin(l / 2r) differ from pi l / L by the relative square of l / r.
  for (const std::size_t n : {12u, 48u, 192u}) {
    std::vector<double> length(n);
    for (std::size_t i = 0; i < n; ++i) length[i] = 1 + 0.5 * std::sin(3.0 * static_cast<double>(i));
    const double sum = std::accumulate(length.begin(), length.end(), 0.0);
    const double longest = *std::max_element(length.begin(), length.end()) / sum;
    const auto polygon = cyclic_polygon(length);
    REQUIRE(polygon);
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 at = polygon->corner[(i + 1) % n];
      const Vec2 back = polygon->corner[i] - at, ahead = polygon->corner[(i + 2) % n] - at;
      const double beta = std::atan2(cross(ahead, back), dot(ahead, back));
      worst = std::max(worst, std::abs(beta - kPi * (1 - (length[i] + length[(i + 1) % n]) / sum)));
    }
    // Each half sector is off by a part of at most pi^2 / 6 longest^2 (and the common radius by as much).
    CHECK(worst < 2 * kPi * 2 * longest * kPi * kPi / 6 * longest * longest);
    CHECK(worst > 0);
  }
  const std::vector<double> equal(9, 1.0);  // and exactly where the edges are equal
  const auto polygon = cyclic_polygon(equal);
  REQUIRE(polygon);
  const Vec2 back = polygon->corner[0] - polygon->corner[1], ahead = polygon->corner[2] - polygon->corner[1];
  CHECK(std::atan2(cross(ahead, back), dot(ahead, back)) ==
        doctest::Approx(kPi * (1 - 2.0 / 9)).epsilon(1e-13));
}

TEST_CASE("cyclic arc: equal edges under a given sweep have radius l / (2 sin(sweep / 2n)) and turn left") {
  for (const double degrees : {1e-3, 1.0, 30.0, 90.0, 179.0, 180.0, 181.0, 270.0, 350.0, 359.9}) {
    const double sweep = degrees * kPi / 180;
    const std::vector<double> length(10, 0.3);
    const auto arc = cyclic_arc(length, sweep);
    REQUIRE(arc);
    REQUIRE(arc->corner.size() == 11);
    CHECK(arc->radius == doctest::Approx(0.15 / std::sin(sweep / 20)).epsilon(1e-10));
    CHECK(worst_arc_edge(*arc, length) < 1e-13);
    CHECK(norm(arc->corner.back() - arc->corner.front()) ==
          doctest::Approx(2 * arc->radius * std::abs(std::sin(sweep / 2))).epsilon(1e-9));
    for (std::size_t i = 2; i < arc->corner.size(); ++i)
      CHECK(cross(arc->corner[i - 1] - arc->corner[i - 2], arc->corner[i] - arc->corner[i - 1]) > 0);
  }
}

TEST_CASE("cyclic arc: uneven edges turn by their half sectors, which sum to the sweep") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const std::vector<double> length = random_lengths(2 + seed % 20, seed);
    const double sweep = 0.01 + (2 * kPi - 0.02) * static_cast<double>(seed) / 101;
    const auto arc = cyclic_arc(length, sweep);
    REQUIRE(arc);
    const double sum = std::accumulate(length.begin(), length.end(), 0.0);
    CHECK(worst_arc_edge(*arc, length) < 1e-11 * sum);
    // From the first tangent to the last one the direction turns by the sweep: the chord by half of it.
    const Vec2 chord = arc->corner.back() - arc->corner.front();
    CHECK(norm(chord - norm(chord) * unit(sweep / 2)) < 1e-9 * sum);
    CHECK(norm(chord) == doctest::Approx(2 * arc->radius * std::sin(sweep / 2)).epsilon(1e-8));
  }
}

TEST_CASE("cyclic arc: a nearly straight one keeps its edges to rounding, and its sagitta is L sweep / 8") {
  const std::vector<double> length = {1, 3, 0.5, 2, 2, 0.5, 3, 1};
  for (const double sweep : {1e-2, 1e-4, 1e-6, 1e-9}) {
    const auto arc = cyclic_arc(length, sweep);
    REQUIRE(arc);
    CHECK(worst_arc_edge(*arc, length) < 1e-13);
    const Vec2 chord = arc->corner.back(), along = (1 / norm(chord)) * chord;
    CHECK(-cross(along, arc->corner[4]) == doctest::Approx(13 * sweep / 8).epsilon(sweep + 1e-6));
  }
}

TEST_CASE("cyclic arc: of a single edge the chord is the edge, for sweeps below and above half a turn") {
  for (const double sweep : {0.5, 3.0, 4.0, 6.0}) {
    const auto arc = cyclic_arc(std::vector<double>{2.0}, sweep);
    REQUIRE(arc);
    CHECK(arc->radius == doctest::Approx(1 / std::sin(sweep / 2)).epsilon(1e-12));
    CHECK(norm(arc->corner[1] - arc->corner[0]) == doctest::Approx(2).epsilon(1e-12));
  }
}
