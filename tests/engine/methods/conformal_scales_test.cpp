#include "engine/methods/conformal_scales.hpp"

#include <doctest/doctest.h>

#include <cstring>

#include "engine/methods/angle_layout.hpp"
#include "tests/engine/methods/method_shapes.hpp"

using namespace planish;

namespace {

struct Scaled {
  shapes::Measured on;
  ScaleNodes nodes;
  std::vector<double> log_length;

  /// u = 0 on the boundary.
  explicit Scaled(Mesh mesh) : on(std::move(mesh)), log_length(on.mesh.corner_vertex.size()) {
    nodes.num_nodes = on.mesh.num_vertices();
    nodes.target.assign(nodes.num_nodes, 2 * kPi);
    for (Index v = 0; v < nodes.num_nodes; ++v) nodes.node.push_back(on.topology.is_boundary(v) ? kNone : v);
    for (Index c = 0; c < static_cast<Index>(log_length.size()); ++c) {
      const Vec3 edge = on.mesh.position[on.mesh.corner_vertex[next_corner(c)]] -
                        on.mesh.position[on.mesh.corner_vertex[c]];
      log_length[c] = std::log(norm(edge));
    }
  }

  ScaleProblem problem() const {
    return {.corner_vertex = on.mesh.corner_vertex,
            .topology = &on.topology,
            .log_length = log_length,
            .nodes = &nodes,
            .order = on.order};
  }
  Result<ScaleSolution> solve(int threads = 2) const {
    return solve_scales(Exec(threads), problem(), 50, {});
  }
};

double hill(double x, double y) { return 0.6 * std::exp(-2 * (x * x + y * y)) + 0.1 * x * y; }

}  // namespace

TEST_CASE("conformal scales: a flat mesh needs none") {
  const Scaled flat(shapes::height_field(12, shapes::flat));
  const auto solution = flat.solve();
  REQUIRE(solution);
  CHECK(solution->converged);
  for (const double u : solution->u) CHECK(std::abs(u) < 1e-12);
}

TEST_CASE("conformal scales: known ones on a flat mesh are found again") {
  Scaled flat(shapes::height_field(12, shapes::flat));
  const auto given = [&](Index v) {
    const Vec3 p = flat.on.mesh.position[v];
    return flat.on.topology.is_boundary(v) ? 0 : 0.2 * std::sin(3 * p.x + 1) * std::cos(2 * p.y);
  };
  for (Index c = 0; c < static_cast<Index>(flat.log_length.size()); ++c)
    flat.log_length[c] -=
        0.5 * (given(flat.on.mesh.corner_vertex[c]) + given(flat.on.mesh.corner_vertex[next_corner(c)]));
  const auto solution = flat.solve();
  REQUIRE(solution);
  CHECK(solution->converged);
  for (Index v = 0; v < flat.on.mesh.num_vertices(); ++v)
    CHECK(solution->u[v] == doctest::Approx(given(v)).epsilon(1e-9).scale(1));
}

TEST_CASE(
    "conformal energy: its gradient is half of what angle sums miss, by finite differences, broken triangles "
    "too") {
  Scaled hilly(shapes::height_field(6, hill));
  shapes::Random random(3);
  for (const double size : {0.1, 3.0}) {  // the second breaks triangles
    std::vector<double> u(hilly.on.mesh.num_vertices(), 0);
    for (std::size_t v = 0; v < u.size(); ++v) {
      if (hilly.nodes.node[v] != kNone) u[v] = size * (random.uniform() - 0.5);
    }
    const ScaleProblem problem = hilly.problem();
    for (std::size_t v = 0; v < u.size(); ++v) {
      if (hilly.nodes.node[v] == kNone) continue;
      constexpr double kStep = 1e-5;
      std::vector<double> ahead = u, behind = u;
      ahead[v] += kStep;
      behind[v] -= kStep;
      const double slope =
          (conformal_energy(Exec(1), problem, ahead) - conformal_energy(Exec(1), problem, behind)) /
          (2 * kStep);
      double sum = 0;  // angles by the law of cosines
      for (Index c = 0; c < static_cast<Index>(hilly.log_length.size()); ++c) {
        if (hilly.on.mesh.corner_vertex[c] != static_cast<Index>(v)) continue;
        const auto length = [&](Index h) {
          return std::exp(hilly.log_length[h] + 0.5 * (u[hilly.on.mesh.corner_vertex[h]] +
                                                       u[hilly.on.mesh.corner_vertex[next_corner(h)]]));
        };
        const double a = length(c), b = length(previous_corner(c)), opposite = length(next_corner(c));
        sum += std::acos(std::clamp((a * a + b * b - opposite * opposite) / (2 * a * b), -1.0, 1.0));
      }
      CHECK(slope == doctest::Approx(0.5 * (2 * kPi - sum)).epsilon(1e-4).scale(1));
    }
  }
}

TEST_CASE("conformal scales: a hill becomes flat to 1e-11, its boundary keeps its lengths") {
  const Scaled hilly(shapes::height_field(25, hill));
  const auto solution = hilly.solve();
  REQUIRE(solution);
  CHECK(solution->converged);
  CHECK(solution->history.size() < 12);
  CHECK(angle_defects(Exec(2), hilly.on.topology, solution->angle).largest() < 1e-11);
  double area = 0;
  for (Index c = 0; c < static_cast<Index>(hilly.log_length.size()); c += 3) {
    const auto length = [&](Index h) {
      return std::exp(hilly.log_length[h] + 0.5 * (solution->u[hilly.on.mesh.corner_vertex[h]] +
                                                   solution->u[hilly.on.mesh.corner_vertex[next_corner(h)]]));
    };
    area += 0.5 * length(c) * length(c + 2) * std::sin(solution->angle[c]);
  }
  const auto uv = lay_out_angles(Exec(2), hilly.on.mesh.corner_vertex, hilly.on.topology, solution->angle,
                                 hilly.on.order, std::vector<double>{area});
  REQUIRE(uv);
  for (const Index c : hilly.on.topology.loop_corner) {
    const Vec2 edge =
        (*uv)[hilly.on.mesh.corner_vertex[next_corner(c)]] - (*uv)[hilly.on.mesh.corner_vertex[c]];
    CHECK(norm(edge) == doctest::Approx(std::exp(hilly.log_length[c])).epsilon(1e-11));
  }
}

TEST_CASE(
    "conformal scales: a shared node takes one u for all its vertices, and their sum of angles is met") {
  Scaled hilly(shapes::height_field(9, hill));
  const std::vector<Index> tied = {0, 1, 2, 3};  // along an edge of the square, its corner among them
  for (const Index v : tied) {
    REQUIRE(hilly.on.topology.is_boundary(v));
    hilly.nodes.node[v] = hilly.nodes.num_nodes;
  }
  ++hilly.nodes.num_nodes;
  hilly.nodes.target.push_back(3.3 * kPi);
  const auto solution = hilly.solve();
  REQUIRE(solution);
  CHECK(solution->converged);
  double sum = 0;
  for (std::size_t c = 0; c < solution->angle.size(); ++c) {
    if (hilly.on.mesh.corner_vertex[c] < 4) sum += solution->angle[c];
  }
  CHECK(sum == doctest::Approx(3.3 * kPi).epsilon(1e-11));
  for (const Index v : tied) CHECK(solution->u[v] == solution->u[0]);
  CHECK(std::abs(solution->u[0]) > 1e-3);
}

TEST_CASE("conformal scales: a spike of slivers that no scale factors flatten is told by its triangles") {
  Scaled spike(shapes::height_field(
      5, [](double x, double y) { return x == 0 && y == 0 ? 0.0 : 0.0; }, 0));
  for (std::size_t c = 0; c < spike.log_length.size(); ++c) {  // one interior edge far longer than the others
    const Index v = spike.on.mesh.corner_vertex[c],
                w = spike.on.mesh.corner_vertex[next_corner(static_cast<Index>(c))];
    if ((v == 6 && w == 7) || (v == 7 && w == 6)) spike.log_length[c] += 6;
  }
  const auto solution = spike.solve();
  REQUIRE(solution);
  CHECK(!solution->converged);
  CHECK(!solution->broken.empty());
}

TEST_CASE("conformal scales: 1, 2 and 7 threads give the same bits") {
  const Scaled wavy(shapes::wavy_disk(9000));
  const auto one = wavy.solve(1);
  REQUIRE(one);
  for (const int threads : {2, 7}) {
    const auto other = wavy.solve(threads);
    REQUIRE(other);
    CHECK(std::memcmp(one->u.data(), other->u.data(), sizeof(double) * one->u.size()) == 0);
  }
}
