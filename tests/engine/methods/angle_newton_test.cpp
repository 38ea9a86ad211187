#include "engine/methods/angle_newton.hpp"

#include <doctest/doctest.h>

#include <cstring>

#include "engine/methods/angle_layout.hpp"
#include "tests/engine/methods/method_shapes.hpp"

using namespace planish;

namespace {

/// Angle-based flattening of a disk, without constraints but for what a test adds.
struct Flattened {
  shapes::Measured on;
  AngleRows rows;
  std::vector<LongAngleRow> long_rows;
  std::vector<double> wanted, weight;

  explicit Flattened(Mesh mesh)
      : on(std::move(mesh)), rows(on.topology), wanted(on.angle), weight(on.angle.size()) {
    const std::vector<double> sum = on.angle_sums();
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      const Index v = on.mesh.corner_vertex[c];
      if (!on.topology.is_boundary(v)) wanted[c] *= 2 * kPi / sum[v];
      weight[c] = 1 / (wanted[c] * wanted[c]);
    }
  }

  Result<AngleSolution> solve(int threads = 2) const {
    const AngleProblem problem{.corner_vertex = on.mesh.corner_vertex,
                               .topology = &on.topology,
                               .rows = &rows,
                               .long_rows = &long_rows,
                               .wanted = wanted,
                               .weight = weight,
                               .order = on.order};
    return solve_angles(Exec(threads), problem, on.angle, 1e-9, 50, {});
  }
};

Mesh bumpy(Index n) {
  return shapes::height_field(
      n, [](double x, double y) { return 0.4 * std::sin(2.5 * x) * std::cos(2 * y) + 0.3 * x * y; });
}

}  // namespace

TEST_CASE("angle newton: a flat mesh keeps its angles") {
  const Flattened flat(shapes::height_field(12, shapes::flat));
  const auto solution = flat.solve();
  REQUIRE(solution);
  CHECK(solution->converged);
  CHECK(shapes::largest_difference(solution->angle, flat.on.angle) < 1e-12);
}

TEST_CASE("angle newton: angles of a curved mesh close around all vertices to 1e-11, in few steps") {
  const Flattened curved(bumpy(25));
  const auto solution = curved.solve();
  REQUIRE(solution);
  CHECK(solution->converged);
  CHECK(solution->history.size() < 12);
  CHECK(angle_defects(Exec(2), curved.on.topology, solution->angle).largest() < 1e-11);
  CHECK(angle_defects(Exec(2), curved.on.topology, curved.on.angle).largest() > 1e-2);
}

TEST_CASE("angle newton: no direction that keeps all conditions lowers the energy at its solution") {
  const Flattened curved(bumpy(7));
  const auto solution = curved.solve();
  REQUIRE(solution);
  // Flat maps near this one: move vertices of its layout, and take the angles of what results.
  const std::vector<double> area = {1};
  const auto uv = lay_out_angles(Exec(1), curved.on.mesh.corner_vertex, curved.on.topology, solution->angle,
                                 curved.on.order, area);
  REQUIRE(uv);
  const auto energy = [&](const std::vector<Vec2>& map) {
    const std::vector<double> angle = shapes::map_angles(curved.on.mesh.corner_vertex, map);
    double sum = 0;
    for (std::size_t c = 0; c < angle.size(); ++c)
      sum += curved.weight[c] * (angle[c] - curved.wanted[c]) * (angle[c] - curved.wanted[c]);
    return sum;
  };
  const double least = energy(*uv);
  for (std::size_t v = 0; v < uv->size(); ++v) {
    for (const Vec2 direction : {Vec2{1, 0}, Vec2{0, 1}}) {
      constexpr double kStep = 1e-4;
      std::vector<Vec2> ahead = *uv, behind = *uv;
      ahead[v] += kStep * direction;
      behind[v] += -kStep * direction;
      const double slope = (energy(ahead) - energy(behind)) / (2 * kStep);
      const double curvature = (energy(ahead) - 2 * least + energy(behind)) / (kStep * kStep);
      CHECK(std::abs(slope) < 1e-5 * curvature);
    }
  }
}

TEST_CASE("angle rows: derivatives agree with finite differences of the residuals") {
  Flattened curved(bumpy(6));
  Index inside = 0;
  while (curved.on.topology.is_boundary(inside)) ++inside;
  curved.rows.add(
      {{inside, {.kind = AngleRow::Kind::Sum, .first = 1, .count = 3, .target = kPi, .constraint = 0}}});
  std::vector<double> cotangent(curved.on.angle.size());
  for (std::size_t c = 0; c < cotangent.size(); ++c) cotangent[c] = 1 / std::tan(curved.on.angle[c]);
  REQUIRE(curved.rows.of(inside).end - curved.rows.of(inside).begin == 3);
  for (Index row = 0; row < curved.rows.size(); ++row) {
    const Index v = curved.rows.vertex_of(row);
    std::vector<double> expected(cotangent.size(), 0);
    for (Index k = curved.on.topology.star_begin[v]; k < curved.on.topology.star_begin[v + 1]; ++k) {
      const Index c = curved.on.topology.star_corner[k];
      const auto d = curved.rows.derivatives(row, c, cotangent);
      expected[c] += d[0];
      expected[next_corner(c)] += d[1];
      expected[previous_corner(c)] += d[2];
    }
    for (std::size_t c = 0; c < expected.size(); ++c) {
      constexpr double kStep = 1e-6;
      std::vector<double> ahead = curved.on.angle, behind = curved.on.angle;
      ahead[c] += kStep;
      behind[c] -= kStep;
      const double slope =
          (curved.rows.residual(row, ahead) - curved.rows.residual(row, behind)) / (2 * kStep);
      CHECK(slope == doctest::Approx(expected[c]).epsilon(1e-7).scale(1));
    }
  }
}

TEST_CASE("angle newton: a prescribed sum is met, and its opposite side follows") {
  Flattened curved(bumpy(9));
  Index inside = 40;  // the middle
  REQUIRE(!curved.on.topology.is_boundary(inside));
  curved.rows.add(
      {{inside, {.kind = AngleRow::Kind::Sum, .first = 0, .count = 3, .target = kPi, .constraint = 0}},
       {inside, {.kind = AngleRow::Kind::Sum, .first = 0, .count = 3, .target = kPi, .constraint = 1}}});
  const auto solution = curved.solve();
  REQUIRE(solution);
  CHECK(solution->converged);
  double sum = 0;
  for (Index k = 0; k < 3; ++k)
    sum += solution->angle[curved.on.topology.star_corner[curved.on.topology.star_begin[inside] + k]];
  CHECK(sum == doctest::Approx(kPi).epsilon(1e-12));
  CHECK(angle_defects(Exec(2), curved.on.topology, solution->angle).largest() < 1e-10);
}

TEST_CASE(
    "angle newton: a long row is met; one that follows from it changes nothing; one that contradicts it is "
    "named") {
  Flattened curved(bumpy(9));
  const auto free = curved.solve();
  REQUIRE(free);
  const LongAngleRow row{.terms = {{0, 1}, {30, -1}, {61, 1}},
                         .target = free->angle[0] - free->angle[30] + free->angle[61] + 0.05,
                         .relation = 4};
  curved.long_rows = {row};
  const auto once = curved.solve();
  REQUIRE(once);
  CHECK(once->converged);
  CHECK(once->angle[0] - once->angle[30] + once->angle[61] == doctest::Approx(row.target).epsilon(1e-11));
  curved.long_rows = {row, row};
  const auto twice = curved.solve();
  REQUIRE(twice);
  CHECK(shapes::largest_difference(once->angle, twice->angle) < 1e-9);
  curved.long_rows[1].target += 0.1;
  curved.long_rows[1].relation = 7;
  const auto never = curved.solve();
  REQUIRE(!never);
  CHECK(never.error().code == ErrorCode::ConstraintsConflict);
  CHECK(never.error().ids == std::vector<Index>{4, 7});
}

TEST_CASE("angle newton: sums that leave no room for an angle do not converge") {
  Flattened curved(bumpy(9));
  curved.rows.add(
      {{40, {.kind = AngleRow::Kind::Sum, .first = 0, .count = 1, .target = 3.3, .constraint = 0}}});
  const auto solution = curved.solve();
  REQUIRE(solution);
  CHECK(!solution->converged);
}

TEST_CASE("angle newton: 1, 2 and 7 threads give the same bits") {
  Flattened curved(shapes::wavy_disk(9000));
  curved.long_rows = {
      {.terms = {{0, 1}, {3000, -1}}, .target = curved.on.angle[0] - curved.on.angle[3000], .relation = 0}};
  const auto one = curved.solve(1);
  REQUIRE(one);
  for (const int threads : {2, 7}) {
    const auto other = curved.solve(threads);
    REQUIRE(other);
    CHECK(std::memcmp(one->angle.data(), other->angle.data(), sizeof(double) * one->angle.size()) == 0);
  }
}

TEST_CASE("angle layout: the angles of a plane mesh give it back up to a similarity, and its area") {
  const shapes::Measured flat(shapes::height_field(30, shapes::flat));
  const auto uv = lay_out_angles(Exec(2), flat.mesh.corner_vertex, flat.topology, flat.angle, flat.order,
                                 std::vector<double>{4});
  REQUIRE(uv);
  CHECK(shapes::largest_difference(shapes::map_angles(flat.mesh.corner_vertex, *uv), flat.angle) < 1e-11);
  const Vec3 p = flat.mesh.position[0], q = flat.mesh.position[899];
  CHECK(norm((*uv)[899] - (*uv)[0]) == doctest::Approx(norm(q - p)).epsilon(1e-12));
}
