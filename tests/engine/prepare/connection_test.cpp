#include "engine/prepare/connection.hpp"

#include <doctest/doctest.h>

#include "engine/prepare/prepare.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/solve/laplacian.hpp"
#include "engine/solve/start.hpp"
#include "kernels/intrinsic/cotangents.hpp"
#include "kernels/intrinsic/curvature.hpp"
#include "kernels/intrinsic/transport.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

struct Prepared {
  PreparedMesh mesh;
  std::vector<RestFrame> frame;
  std::vector<double> cotangent, angle_sum;
  std::vector<Index> order;

  explicit Prepared(const Mesh& input) : mesh(prepare(Exec(1), input.surface()).value()) {
    const Surface s = mesh.mesh.surface();
    const Range all{0, s.num_triangles()};
    frame.resize(s.num_triangles());
    cotangent.resize(s.corner_vertex.size());
    angle_sum.resize(s.position.size());
    std::vector<double> angle(s.corner_vertex.size());
    std::vector<std::uint8_t> mollified(s.num_triangles());
    rest_frames(all, s.position, s.corner_vertex, frame);
    cotangents(all, frame, cotangent, mollified);
    corner_angles(all, frame, angle);
    angle_sums({0, s.num_vertices()}, angle, mesh.topology.stars(), mesh.topology.star_corner, angle_sum);
    for (Index v = 0; v < s.num_vertices(); ++v) order.push_back(v);
  }
  StartInput input() const {
    return {mesh.mesh.corner_vertex, &mesh.topology, frame, cotangent, angle_sum, order};
  }
};

/// Rotation around a vertex when its star is walked once: 0 modulo 2 pi where the star closes.
double star_holonomy(const Prepared& p, In<Vec2> rotation, Index v) {
  double turn = 0;
  for (const Index c : slice(In<Index>(p.mesh.topology.star_corner), p.mesh.topology.stars().group(v))) {
    const Index crossed = previous_corner(c), twin = p.mesh.topology.corner_twin[crossed];
    const double step = argument(multiply(rotation[twin / 3], conjugate(rotation[crossed / 3])));
    turn += reduce_angle(step - unfold_angle(0, crossed, twin, p.frame));
  }
  return turn;
}

double bump(double x, double y) { return 0.5 * std::exp(-3 * (x * x + y * y)); }

}  // namespace

TEST_CASE("connection: on a flat annulus every right-hand side is 0, the hole's too") {
  const Prepared p(shapes::frame(25, shapes::flat));
  const RotationRows rows = rotation_rows(p.mesh.topology, p.mesh.mesh.corner_vertex, p.angle_sum);
  CHECK(rows.num_nodes == p.mesh.mesh.num_vertices() + 1);
  for (const double target : rows.target) CHECK(std::abs(target) < 1e-10);
}

TEST_CASE("connection: a hole's right-hand side is the curvature that the hole carries") {
  // Gauss-Bonnet on the disk that the hole would be filled to: 2 pi - (turning of its boundary) is its
  // curvature.
  const Prepared p(shapes::frame(40, bump));
  const RotationRows rows = rotation_rows(p.mesh.topology, p.mesh.mesh.corner_vertex, p.angle_sum);
  double all = 0;
  for (const double target : rows.target) all += target;
  double outer_turning = 0;
  const Topology& topology = p.mesh.topology;
  for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(rows.outer_loop[0]))) {
    outer_turning += kPi - p.angle_sum[p.mesh.mesh.corner_vertex[c]];
  }
  CHECK(all + outer_turning == doctest::Approx(2 * kPi).epsilon(1e-10));
}

TEST_CASE("connection: the rotations of both norms close every star to 1e-9, on a disk and around a hole") {
  for (const Mesh& mesh : {shapes::wavy_disk(3000), shapes::frame(40, bump)}) {
    const Prepared p(mesh);
    for (const Init init : {Init::Uniform, Init::Cotangent}) {
      const auto start = first_rotations(Exec(2), p.input(), init);
      REQUIRE(start);
      CHECK(start->holonomy_residual < 1e-9);
      double worst = 0;
      for (Index v = 0; v < p.mesh.mesh.num_vertices(); ++v) {
        if (p.mesh.topology.is_boundary(v)) continue;
        // The extra rotations around the star sum to the angle defect (DESIGN 3.1).
        worst = std::max(worst, std::abs(star_holonomy(p, start->rotation, v) - (2 * kPi - p.angle_sum[v])));
      }
      CHECK(worst < 1e-9);
    }
  }
}

TEST_CASE(
    "connection: an analysis of all vertices serves for the rotations, and is left alone where holes merge "
    "some") {
  for (const bool has_hole : {false, true}) {
    const Prepared p(has_hole ? shapes::frame(40, bump) : shapes::wavy_disk(3000));
    const Index num_vertices = p.mesh.mesh.num_vertices();
    std::vector<std::uint8_t> held(num_vertices, 0);
    held[num_vertices / 2] = 1;
    const auto weight = [](Index) { return 2.0; };
    const SymmetricMatrix positions =
        held_laplacian(Exec(2), p.mesh.mesh.corner_vertex, p.mesh.topology, held, weight);
    auto global = GlobalPhase::factor(Exec(2), positions, p.order);
    REQUIRE(global);
    std::vector<Vec2> rhs(num_vertices), before(num_vertices), after(num_vertices);
    for (Index v = 0; v < num_vertices; ++v) rhs[v] = {std::sin(v), std::cos(v)};
    global->solve(Exec(2), rhs, before);
    for (const Init init : {Init::Uniform, Init::Cotangent}) {
      const auto own = first_rotations(Exec(2), p.input(), init),
                 shared = first_rotations(Exec(2), p.input(), init, &*global);
      REQUIRE(own);
      REQUIRE(shared);
      CHECK(shared->holonomy_residual < 1e-9);
      for (std::size_t t = 0; t < own->rotation.size(); ++t)
        CHECK(norm(own->rotation[t] - shared->rotation[t]) < 1e-10);
      global->solve(Exec(2), rhs, after);
      CHECK((after == before) == has_hole);
      REQUIRE(global->refactor(Exec(2), positions));
      global->solve(Exec(2), rhs, after);
      CHECK(after == before);
    }
  }
}

TEST_CASE("connection: on a flat mesh unfolding alone gives one common rotation") {
  const Prepared p(shapes::height_field(20, shapes::flat));
  const auto start = first_rotations(Exec(1), p.input(), Init::Identity);
  REQUIRE(start);
  const auto direction = [&](Index t) {  // image of the mesh's x axis
    const Vec3 e = p.mesh.mesh.position[p.mesh.mesh.corner_vertex[3 * t + 1]] -
                   p.mesh.mesh.position[p.mesh.mesh.corner_vertex[3 * t]];
    return multiply(start->rotation[t], conjugate(unit(std::atan2(e.y, e.x))));
  };
  for (Index t = 0; t < p.mesh.mesh.num_triangles(); ++t) CHECK(norm(direction(t) - direction(0)) < 1e-12);
}

TEST_CASE(
    "connection: the uniform solution is the smallest: adding any potential's gradient makes it longer") {
  const Prepared p(shapes::wavy_disk(800));
  const Topology& topology = p.mesh.topology;
  const In<Index> corner = p.mesh.mesh.corner_vertex;
  const auto start = first_rotations(Exec(1), p.input(), Init::Uniform);
  const auto harmonic = first_rotations(Exec(1), p.input(), Init::Cotangent);
  const auto squared_length = [&](In<Vec2> rotation) {
    double sum = 0;
    for (Index c = 0; c < static_cast<Index>(corner.size()); ++c) {
      const Index twin = topology.corner_twin[c];
      if (twin == kNone || twin < c) continue;
      const double step = argument(multiply(rotation[twin / 3], conjugate(rotation[c / 3])));
      const double w = reduce_angle(step - unfold_angle(0, c, twin, p.frame));
      sum += w * w;
    }
    return sum;
  };
  CHECK(squared_length(start->rotation) < squared_length(harmonic->rotation));
}
