#include "engine/solve/global_phase.hpp"

#include <numeric>
#include <Eigen/SparseCholesky>
#include <doctest/doctest.h>

#include "engine/prepare/prepare.hpp"
#include "engine/solve/laplacian.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

Eigen::SparseMatrix<double> to_eigen(const SymmetricMatrix& matrix) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < matrix.size(); ++j) {
    for (Index k = matrix.column_begin[j]; k < matrix.column_begin[j + 1]; ++k) {
      entries.emplace_back(matrix.row[k], j, matrix.value[k]);
      if (matrix.row[k] != j) entries.emplace_back(j, matrix.row[k], matrix.value[k]);
    }
  }
  Eigen::SparseMatrix<double> result(matrix.size(), matrix.size());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

SymmetricMatrix held_laplacian(const Mesh& mesh) {
  const Topology topology = build_topology(Exec(1), mesh.surface());
  std::vector<std::uint8_t> held(mesh.num_vertices(), 0);
  held[0] = 1;
  return vertex_laplacian(Exec(1), mesh.corner_vertex, topology, held, [](Index) { return 1.5; });
}

}  // namespace

TEST_CASE("global phase: solves agree with Eigen's Cholesky to 1e-10, on trees of one and of many tasks") {
  for (const Index triangles : {2, 50, 3000, 60000}) {
    const SymmetricMatrix matrix = held_laplacian(shapes::wavy_disk(triangles));
    const auto order = fill_reducing_order(Exec(2), matrix);
    REQUIRE(order);
    const auto global = GlobalPhase::factor(Exec(2), matrix, *order);
    REQUIRE(global);
    shapes::Random random(9);
    std::vector<Vec2> rhs(matrix.size()), x(matrix.size());
    for (Vec2& b : rhs) b = {random.uniform(), random.uniform() - 0.5};
    global->solve(Exec(2), rhs, x);
    Eigen::MatrixX2d b(matrix.size(), 2);
    for (Index i = 0; i < matrix.size(); ++i) b.row(i) << rhs[i].x, rhs[i].y;
    const Eigen::MatrixX2d expected =
        Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>(to_eigen(matrix)).solve(b);
    double worst = 0;
    for (Index i = 0; i < matrix.size(); ++i) {
      worst = std::max(worst, std::hypot(x[i].x - expected(i, 0), x[i].y - expected(i, 1)));
    }
    CHECK(worst < 1e-10 * expected.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("global phase: 1, 2 and 7 threads give the same bits") {
  const SymmetricMatrix matrix = held_laplacian(shapes::wavy_disk(40000));
  const auto order = fill_reducing_order(Exec(2), matrix);
  std::vector<Vec2> rhs(matrix.size(), {1, -1});
  for (const bool rounded : {false, true}) {
    const auto solve = [&](int threads) {
      std::vector<Vec2> x(matrix.size());
      auto global = GlobalPhase::factor(Exec(threads), matrix, *order);
      if (rounded) global->round(Exec(threads));
      global->solve(Exec(threads), rhs, x);
      return x;
    };
    const auto one = solve(1);
    CHECK(solve(2) == one);
    CHECK(solve(7) == one);
  }
}

TEST_CASE(
    "global phase: analysed first and factored later, and again after it was rounded, the bits are the "
    "same") {
  const SymmetricMatrix matrix = held_laplacian(shapes::wavy_disk(3000));
  const auto order = fill_reducing_order(Exec(2), matrix);
  const auto at_once = GlobalPhase::factor(Exec(2), matrix, *order);
  auto later = GlobalPhase::analyse(Exec(2), matrix, *order);
  REQUIRE(later);
  CHECK(later->factor_nonzeros() == at_once->factor_nonzeros());
  const std::vector<Vec2> rhs(matrix.size(), {1, -1});
  std::vector<Vec2> expected(rhs.size()), x(rhs.size());
  at_once->solve(Exec(2), rhs, expected);
  for (int round = 0; round < 2; ++round) {
    REQUIRE(later->refactor(Exec(2), matrix));
    later->solve(Exec(2), rhs, x);
    CHECK(x == expected);
    later->round(Exec(2));
    CHECK(later->is_rounded());
  }
}

TEST_CASE("global phase: a matrix that is not positive definite is an error that names the row") {
  const SymmetricMatrix matrix = held_laplacian(shapes::wavy_disk(100));
  std::vector<Index> order(matrix.size());
  std::iota(order.begin(), order.end(), 0);
  for (const Index row : {7, 30}) {
    SymmetricMatrix broken = matrix;
    broken.value[broken.column_begin[row]] = -1000;
    const auto global = GlobalPhase::factor(Exec(2), broken, order);
    REQUIRE_FALSE(global);
    CHECK(global.error().code == ErrorCode::FactorizationFailed);
    CHECK(global.error().ids == std::vector<Index>{row});
  }
}

TEST_CASE("laplacian: constants are in its null space where nothing is held") {
  const Mesh mesh = shapes::frame(20, shapes::flat);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  const std::vector<std::uint8_t> held(mesh.num_vertices(), 0);
  const auto matrix = to_eigen(vertex_laplacian(Exec(2), mesh.corner_vertex, topology, held, [&](Index c) {
    return 1.0 + std::min(c, topology.corner_twin[c]) % 5;
  }));
  CHECK((matrix * Eigen::VectorXd::Ones(matrix.cols())).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("laplacian: whatever is held, the pattern is that of all vertices, and the rest is theirs") {
  const Mesh mesh = shapes::wavy_disk(300);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  const auto weight = [](Index c) { return 1 + 0.001 * (c / 3); };
  const auto n = static_cast<Index>(mesh.position.size());
  std::vector<std::uint8_t> none(n, 0), some(n, 0);
  for (Index v = 0; v < n; v += 7) some[v] = 1;
  const auto weight_of = [&](Index c) {
    const Index twin = topology.corner_twin[c];
    return weight(twin == kNone ? c : std::min(c, twin));
  };
  const SymmetricMatrix free = held_laplacian(Exec(2), mesh.corner_vertex, topology, none, weight_of),
                        held = held_laplacian(Exec(2), mesh.corner_vertex, topology, some, weight_of);
  CHECK(held.column_begin == free.column_begin);
  CHECK(held.row == free.row);
  const auto difference = [&](const SymmetricMatrix& a, In<std::uint8_t> fixed) {
    const SymmetricMatrix b = vertex_laplacian(Exec(1), mesh.corner_vertex, topology, fixed, weight_of);
    return Eigen::MatrixXd(to_eigen(a) - to_eigen(b)).norm();
  };
  CHECK(difference(free, none) == 0);
  CHECK(difference(held, some) == 0);
}

TEST_CASE("laplacian: merging the vertices of a hole is the product with the merging matrix") {
  const Mesh mesh = shapes::frame(12, shapes::flat);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  const Index num_vertices = mesh.num_vertices();
  std::vector<Index> node(num_vertices);
  std::iota(node.begin(), node.end(), 0);
  for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(0)))
    node[mesh.corner_vertex[c]] = kNone;
  for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(1))) {
    node[mesh.corner_vertex[c]] = num_vertices;
  }
  const auto weight = [](Index) { return 2.0; };
  const auto merged =
      to_eigen(quotient_laplacian(Exec(2), mesh.corner_vertex, topology, node, num_vertices + 1, weight));
  const auto plain = to_eigen(vertex_laplacian(Exec(1), mesh.corner_vertex, topology,
                                               std::vector<std::uint8_t>(num_vertices, 0), weight));
  Eigen::SparseMatrix<double> merging(num_vertices, num_vertices + 1);
  for (Index v = 0; v < num_vertices; ++v) {
    if (node[v] != kNone) merging.insert(v, node[v]) = 1;
  }
  Eigen::MatrixXd difference =
      Eigen::MatrixXd(merged) - Eigen::MatrixXd(merging.transpose() * plain * merging);
  for (Index v = 0; v < num_vertices; ++v) {
    if (node[v] != v) difference(v, v) -= 1;  // unit rows of nodes that stand for nothing
  }
  CHECK(difference.cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("global phase: a rounded factor solves with one symmetric matrix near the given one") {
  const SymmetricMatrix matrix = held_laplacian(shapes::wavy_disk(3000));
  auto global = GlobalPhase::factor(Exec(2), matrix, *fill_reducing_order(Exec(2), matrix));
  REQUIRE(global);
  shapes::Random random(10);
  std::vector<Vec2> a(matrix.size()), b(matrix.size()), x(matrix.size()), y(matrix.size()),
      exact(matrix.size());
  for (Index i = 0; i < matrix.size(); ++i) {
    a[i] = {random.uniform() - 0.5, random.uniform() - 0.5};
    b[i] = {random.uniform() - 0.5, random.uniform() - 0.5};
  }
  global->solve(Exec(1), a, exact);
  CHECK_FALSE(global->is_rounded());
  global->round(Exec(2));
  CHECK(global->is_rounded());
  global->solve(Exec(1), a, x);
  global->solve(Exec(1), b, y);
  double error = 0, size = 0, b_x = 0, a_y = 0;
  for (Index i = 0; i < matrix.size(); ++i) {
    error = std::max(error, norm(x[i] - exact[i]));
    size = std::max(size, norm(exact[i]));
    b_x += dot(b[i], x[i]);
    a_y += dot(a[i], y[i]);
  }
  CHECK(error > 1e-12 * size);  // it is another matrix
  CHECK(error < 1e-3 * size);
  CHECK(b_x == doctest::Approx(a_y).epsilon(1e-5));
  REQUIRE(global->refactor(Exec(2), matrix));
  CHECK_FALSE(global->is_rounded());
}
