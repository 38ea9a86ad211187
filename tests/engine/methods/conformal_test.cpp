// The conformal energy and the maps that lower it, against formulas, a dense eigen-solver and invariances.
#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "engine/flatten.hpp"
#include "engine/methods/at_rest.hpp"
#include "engine/methods/conformal_energy.hpp"
#include "engine/methods/spectral.hpp"
#include "engine/prepare/connection.hpp"
#include "kernels/local/jacobians.hpp"
#include "kernels/local/svd2.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

double bowl(double x, double y) { return 0.6 * x * x + 0.3 * y * y + 0.2 * x * y * y; }

Workpiece workpiece_of(const Exec& exec, const Mesh& mesh) {
  auto piece = make_workpiece(exec, mesh.surface());
  REQUIRE(piece);
  piece->outer_loop = outer_loops(piece->topology());
  return std::move(*piece);
}

std::vector<Vec2> random_map(std::size_t n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Vec2> uv(n);
  for (Vec2& z : uv) z = {random.uniform(), random.uniform()};
  return uv;
}

/// Sum of A (s1 - s2)^2 / 2 by the triangles' Jacobians.
double energy_by_stretch(const Mesh& mesh, In<Vec2> uv) {
  double sum = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const Index* v = &mesh.corner_vertex[3 * static_cast<std::size_t>(t)];
    const RestFrame frame = rest_frame(mesh.position[v[0]], mesh.position[v[1]], mesh.position[v[2]]);
    const SingularValues s = singular_values(jacobian(frame, uv[v[0]], uv[v[1]], uv[v[2]]));
    sum += 0.5 * area(frame) * (s.sigma_max - s.sigma_min) * (s.sigma_max - s.sigma_min);
  }
  return sum;
}

/// Twice the energy as a quadratic form over u_0, v_0, u_1, ..., from |dz/dx + i dz/dy|^2 of each triangle: no cotangents,
/// no areas of the map.
Eigen::MatrixXd dense_hessian(const Mesh& mesh) {
  const Eigen::Index n = 2 * mesh.num_vertices();
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const Index* v = &mesh.corner_vertex[3 * static_cast<std::size_t>(t)];
    const RestFrame f = rest_frame(mesh.position[v[0]], mesh.position[v[1]], mesh.position[v[2]]);
    // Gradients of the hat functions.
    const double twice = f.x1 * f.y2;
    const Vec2 gradient[3] = {
        {-f.y2 / twice, (f.x2 - f.x1) / twice}, {f.y2 / twice, -f.x2 / twice}, {0, f.x1 / twice}};
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2, 6);  // u_x - v_y and u_y + v_x
    for (int i = 0; i < 3; ++i) {
      rows(0, 2 * i) = gradient[i].x;
      rows(0, 2 * i + 1) = -gradient[i].y;
      rows(1, 2 * i) = gradient[i].y;
      rows(1, 2 * i + 1) = gradient[i].x;
    }
    const Eigen::MatrixXd local = area(f) * rows.transpose() * rows;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) hessian(2 * v[i / 2] + i % 2, 2 * v[j / 2] + j % 2) += local(i, j);
    }
  }
  return hessian;
}

Eigen::VectorXd dense_boundary_mass(const Mesh& mesh) {
  std::map<std::pair<Index, Index>, int> count;
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    const auto [a, b] = std::minmax(mesh.corner_vertex[c], mesh.corner_vertex[next_corner(c)]);
    ++count[{a, b}];
  }
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(2 * mesh.num_vertices());
  for (const auto& [edge, triangles] : count) {
    if (triangles == 2) continue;
    const double half = 0.5 * norm(mesh.position[edge.first] - mesh.position[edge.second]);
    for (const Index v : {edge.first, edge.second}) {
      mass[2 * v] += half;
      mass[2 * v + 1] += half;
    }
  }
  return mass;
}

bool same_bits(In<Vec2> a, In<Vec2> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

TEST_CASE("conformal energy: the mean over triangles of (s1 - s2)^2 / 2 for every map") {
  const Exec exec(1);
  const Mesh mesh = shapes::frame(9, bowl);
  const Workpiece piece = workpiece_of(exec, mesh);
  const ConformalEnergy energy(exec, piece);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const std::vector<Vec2> uv = random_map(mesh.position.size(), seed);
    std::vector<Vec2> ordered;
    for (const Index v : piece.mesh().vertex_origin) ordered.push_back(uv[v]);
    CHECK(energy.value(ordered) == doctest::Approx(energy_by_stretch(mesh, uv)).epsilon(1e-12));
  }
}

TEST_CASE("conformal energy: forces are its derivatives") {
  const Exec exec(1);
  const Workpiece piece = workpiece_of(exec, shapes::frame(9, bowl));
  const ConformalEnergy energy(exec, piece);
  std::vector<Vec2> uv = random_map(piece.component.size(), 5), force(uv.size());
  energy.forces(uv, force);
  constexpr double kStep = 1e-3;  // a quadratic form has no error of differences
  for (std::size_t v = 0; v < uv.size(); v += 7) {
    const auto difference = [&](double Vec2::*part) {
      const double at = uv[v].*part;
      uv[v].*part = at + kStep;
      const double above = energy.value(uv);
      uv[v].*part = at - kStep;
      const double below = energy.value(uv);
      uv[v].*part = at;
      return (above - below) / (2 * kStep);
    };
    CHECK(force[v].x == doctest::Approx(difference(&Vec2::x)).epsilon(1e-8));
    CHECK(force[v].y == doctest::Approx(difference(&Vec2::y)).epsilon(1e-8));
  }
}

TEST_CASE("conformal maps: flat surfaces come back as they are, those with holes too") {
  for (const Mesh& flat : {shapes::height_field(12, shapes::flat), shapes::frame(9, shapes::flat)}) {
    const Mesh mesh = shapes::rigid_motion(flat, 3);
    for (const Method method : {Method::Lscm, Method::Dncp, Method::Spectral}) {
      const auto map = flatten(mesh.surface(), {.method = method});
      REQUIRE(map);
      CHECK(map->method == method);
      CHECK(map->certificate.arap < 1e-18);
      CHECK(map->certificate.flipped_triangles == 0);
    }
  }
}

TEST_CASE("conformal maps: lscm and dncp are one map, and its size is the one of least ARAP energy") {
  const Mesh mesh = shapes::height_field(20, bowl);
  const auto lscm = flatten(mesh.surface(), {.method = Method::Lscm});
  const auto dncp = flatten(mesh.surface(), {.method = Method::Dncp});
  REQUIRE(lscm);
  REQUIRE(dncp);
  CHECK(same_bits(lscm->uv, dncp->uv));
  const auto arap_at = [&](double scale) {
    double sum = 0;
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      const Index* v = &mesh.corner_vertex[3 * static_cast<std::size_t>(t)];
      const RestFrame f = rest_frame(mesh.position[v[0]], mesh.position[v[1]], mesh.position[v[2]]);
      const SingularValues s = singular_values(jacobian(f, lscm->uv[v[0]], lscm->uv[v[1]], lscm->uv[v[2]]));
      sum += area(f) * (std::pow(scale * s.sigma_max - 1, 2) + std::pow(scale * s.sigma_min - 1, 2));
    }
    return sum;
  };
  CHECK(arap_at(1) < arap_at(1 + 1e-4));
  CHECK(arap_at(1) < arap_at(1 - 1e-4));
}

TEST_CASE("spectral: the quotient and the vector are those of a dense eigen-solver") {
  for (const Mesh& mesh : {shapes::height_field(9, bowl), shapes::frame(9, bowl)}) {
    const auto map = flatten(mesh.surface(), {.method = Method::Spectral});
    REQUIRE(map);
    const Eigen::MatrixXd hessian = dense_hessian(mesh);
    Eigen::MatrixXd mass = dense_boundary_mass(mesh).asDiagonal();
    // Largest of mass over hessian + mass: two constants with 1, then the pair that is sought.
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass, hessian + mass);
    const Eigen::Index n = hessian.rows();
    const double lambda = 1 / solver.eigenvalues()[n - 3] - 1;
    CHECK(1 / solver.eigenvalues()[n - 4] - 1 == doctest::Approx(lambda).epsilon(1e-8));
    Eigen::VectorXd z(n);
    for (Index v = 0; v < mesh.num_vertices(); ++v) z.segment<2>(2 * v) << map->uv[v].x, map->uv[v].y;
    // Constants and the pair span what a map of least quotient can be.
    const Eigen::MatrixXd best = solver.eigenvectors().rightCols(4);
    const Eigen::VectorXd part = best * (best.transpose() * ((hessian + mass) * z));
    CHECK((z - part).norm() < 1e-7 * z.norm());
    const Eigen::VectorXd ones_u = Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return i % 2 == 0; }),
                          ones_v = Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return i % 2 == 1; });
    const double whole = ones_u.dot(mass * ones_u);
    const Eigen::VectorXd centred =
        z - (ones_u.dot(mass * z) / whole) * ones_u - (ones_v.dot(mass * z) / whole) * ones_v;
    CHECK(centred.dot(hessian * centred) / centred.dot(mass * centred) ==
          doctest::Approx(lambda).epsilon(1e-9));
  }
}

TEST_CASE("conformal maps: components of unlike sizes are each the map that they are alone") {
  const Mesh a = shapes::height_field(10, bowl), b = shapes::scaled(shapes::wavy_disk(300), 3);
  for (const Method method : {Method::Lscm, Method::Spectral}) {
    const auto both = flatten(shapes::joined(a, b).surface(), {.method = method});
    const auto alone = flatten(b.surface(), {.method = method});
    REQUIRE(both);
    REQUIRE(alone);
    // Up to where it lies: edges from one vertex to all others.
    const std::size_t first = a.position.size();
    for (std::size_t v = 0; v < b.position.size(); ++v)
      CHECK(norm(both->uv[first + v] - both->uv[first]) ==
            doctest::Approx(norm(alone->uv[v] - alone->uv[0])).epsilon(1e-6));
  }
}

TEST_CASE("at rest: a small step ends an iteration, and so do steps at the rounding that shrink no more") {
  AtRest small(1e-9, 1e-6);
  CHECK_FALSE(small(1e-3));
  CHECK(small(1e-10));
  AtRest rounding(1e-9, 1e-6);
  int steps = 0;
  while (!rounding(steps % 2 ? 3e-8 : 2e-8) && steps < 100) ++steps;
  CHECK(steps < 10);
  AtRest wandering(1e-9, 1e-6);
  for (int step = 0; step < 100; ++step) CHECK_FALSE(wandering(1e-3));
}

TEST_CASE("conformal maps: 1, 2 and 7 threads give the same bits") {
  const Mesh mesh = shapes::wavy_disk(12000);
  for (const Method method : {Method::Lscm, Method::Spectral}) {
    const auto one = flatten(mesh.surface(), {.method = method, .threads = 1});
    REQUIRE(one);
    for (const int threads : {2, 7}) {
      const auto many = flatten(mesh.surface(), {.method = method, .threads = threads});
      REQUIRE(many);
      CHECK(same_bits(one->uv, many->uv));
    }
  }
}

TEST_CASE("conformal maps: a single triangle comes back as it is") {
  const Mesh mesh = shapes::triangle({0, 0, 0}, {2, 0, 1}, {0, 1, 0});
  for (const Method method : {Method::Lscm, Method::Spectral}) {
    const auto map = flatten(mesh.surface(), {.method = method});
    REQUIRE(map);
    CHECK(map->certificate.arap < 1e-20);
  }
}

TEST_CASE("methods: options of ARAP that a method has no use for are refused, not ignored") {
  const Mesh mesh = shapes::height_field(5, bowl);
  const auto code = [&](const FlattenOptions& options) {
    const auto map = flatten(mesh.surface(), options);
    return map ? ErrorCode::InternalDefect : map.error().code;
  };
  for (const Method method : {Method::Lscm, Method::Dncp, Method::Spectral}) {
    CHECK(code({.method = method, .flips = Flips::Keep}) == ErrorCode::BadUsage);
    CHECK(code({.method = method, .energy = Energy::SymmetricDirichlet}) == ErrorCode::BadUsage);
    CHECK(code({.method = method, .overlaps = Overlapping::Remove}) == ErrorCode::BadUsage);
    CHECK(code({.method = method, .init = Init::Harmonic}) == ErrorCode::BadUsage);
    CHECK(code({.method = method, .tolerance = 1e-3}) == ErrorCode::BadUsage);
    CHECK(code({.method = method, .max_iterations = 3}) == ErrorCode::BadUsage);
    CHECK(code({.method = method, .paper = true}) == ErrorCode::BadUsage);
  }
  CHECK(code({.method = Method::Deform, .overlaps = Overlapping::Remove}) == ErrorCode::BadUsage);
  CHECK(flatten(mesh.surface(), {.method = Method::Deform, .flips = Flips::Keep}));
}
