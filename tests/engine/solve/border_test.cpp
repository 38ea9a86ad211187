#include "engine/solve/border.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <Eigen/Dense>

#include "engine/solve/laplacian.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// K = shift + random couplings, diagonally dominant: positive definite.
SymmetricMatrix random_matrix(Index n, std::uint64_t seed) {
  shapes::Random random(seed);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  for (Index j = 0; j < n; ++j) {
    dense(j, j) += 0.1 + random.uniform();
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<Index>(random.bits() % static_cast<std::uint64_t>(n));
      if (i == j) continue;
      const double w = 2 * random.uniform() - 0.5;
      dense(i, j) -= w, dense(j, i) -= w;
      dense(i, i) += std::abs(w), dense(j, j) += std::abs(w);
    }
  }
  SymmetricMatrix matrix{.column_begin = {0}, .row = {}, .value = {}};
  for (Index j = 0; j < n; ++j) {
    for (Index i = j; i < n; ++i) {
      if (dense(i, j) == 0) continue;
      matrix.row.push_back(i);
      matrix.value.push_back(dense(i, j));
    }
    matrix.column_begin.push_back(static_cast<Index>(matrix.row.size()));
  }
  return matrix;
}

SymmetricMatrix mesh_matrix(Index triangles) {
  const Mesh mesh = shapes::wavy_disk(triangles);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  std::vector<std::uint8_t> held(mesh.num_vertices(), 0);
  held[0] = 1;
  return vertex_laplacian(Exec(1), mesh.corner_vertex, topology, held, [](Index) { return 1.5; });
}

Eigen::MatrixXd dense(const SymmetricMatrix& matrix) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(matrix.size(), matrix.size());
  for (Index j = 0; j < matrix.size(); ++j) {
    for (Index k = matrix.column_begin[j]; k < matrix.column_begin[j + 1]; ++k)
      result(matrix.row[k], j) = result(j, matrix.row[k]) = matrix.value[k];
  }
  return result;
}

/// m columns with `entries` rows each, distinct.
std::vector<SparseColumn> random_columns(Index n, Index m, Index entries, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<SparseColumn> columns(m);
  for (SparseColumn& column : columns) {
    while (static_cast<Index>(column.row.size()) < std::min(n, entries)) {
      const auto row = static_cast<Index>(random.bits() % static_cast<std::uint64_t>(n));
      if (std::find(column.row.begin(), column.row.end(), row) != column.row.end()) continue;
      column.row.push_back(row);
      column.value.push_back({random.uniform() - 0.5, random.uniform() - 0.5});
    }
  }
  return columns;
}

std::vector<Vec2> random_points(Index n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Vec2> point(n);
  for (Vec2& p : point) p = {random.uniform() - 0.5, random.uniform()};
  return point;
}

/// The whole as one real system: u, v, then the border.
struct RealSystem {
  Eigen::MatrixXd matrix;
  std::vector<double> corner;  ///< D
  Index n = 0, m = 0;

  /// D: what the inner system takes from the border, and `margin` more.
  RealSystem(const SymmetricMatrix& inner, const std::vector<SparseColumn>& columns, double margin)
      : n(inner.size()), m(static_cast<Index>(columns.size())) {
    matrix = Eigen::MatrixXd::Zero(2 * n + m, 2 * n + m);
    const Eigen::MatrixXd k = dense(inner);
    matrix.block(0, 0, n, n) = matrix.block(n, n, n, n) = k;
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(2 * n, m);
    for (Index j = 0; j < m; ++j) {
      for (std::size_t i = 0; i < columns[j].row.size(); ++i) {
        b(columns[j].row[i], j) = columns[j].value[i].x;
        b(n + columns[j].row[i], j) = columns[j].value[i].y;
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> llt(k);
    Eigen::MatrixXd d = margin * Eigen::MatrixXd::Identity(m, m);
    for (const Index first : {Index{0}, n}) {
      const Eigen::MatrixXd part = b.middleRows(first, n);
      d += part.transpose() * llt.solve(part);
    }
    d = (0.5 * (d + d.transpose())).eval();
    matrix.block(0, 2 * n, 2 * n, m) = b;
    matrix.block(2 * n, 0, m, 2 * n) = b.transpose();
    matrix.block(2 * n, 2 * n, m, m) = d;
    corner.assign(d.data(), d.data() + d.size());
  }

  Eigen::VectorXd solve(In<Vec2> rhs, In<double> rhs_border) const {
    Eigen::VectorXd right(2 * n + m);
    for (Index i = 0; i < n; ++i) right[i] = rhs[i].x, right[n + i] = rhs[i].y;
    for (Index j = 0; j < m; ++j) right[2 * n + j] = rhs_border[j];
    return matrix.ldlt().solve(right);
  }
};

void check_against_dense(const SymmetricMatrix& matrix, Index m, Index entries, std::uint64_t seed) {
  const auto order = fill_reducing_order(Exec(2), matrix);
  REQUIRE(order);
  const auto global = GlobalPhase::factor(Exec(2), matrix, *order);
  REQUIRE(global);
  const std::vector<SparseColumn> columns = random_columns(matrix.size(), m, entries, seed);
  const RealSystem whole(matrix, columns, 0.7);
  const auto bordered = BorderedPhase::factor(Exec(2), *global, columns, whole.corner);
  REQUIRE(bordered);
  CHECK(bordered->size() == m);
  std::vector<Vec2> x = random_points(matrix.size(), seed + 1);
  std::vector<double> y(m, 0.3);
  for (Index j = 0; j < m; ++j) y[j] -= 0.1 * j;
  const Eigen::VectorXd expected = whole.solve(x, y);
  bordered->solve(Exec(2), x, y, x, y);  // in place
  double worst = 0;
  for (Index i = 0; i < matrix.size(); ++i)
    worst = std::max(worst, std::hypot(x[i].x - expected[i], x[i].y - expected[matrix.size() + i]));
  for (Index j = 0; j < m; ++j) worst = std::max(worst, std::abs(y[j] - expected[2 * matrix.size() + j]));
  CHECK(worst < 1e-10 * expected.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE("border: solves agree with the dense real system, on random matrices and on a mesh's Laplacian") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto n = static_cast<Index>(3 + 9 * seed);
    const auto m = static_cast<Index>(1 + seed % 5);
    check_against_dense(random_matrix(n, seed), m, 3, seed);
    check_against_dense(random_matrix(n, seed), m, n, seed);  // full columns
  }
  check_against_dense(mesh_matrix(600), 7, 5, 3);
}

TEST_CASE("border: more unknowns in the border than inside are solved too") {
  check_against_dense(random_matrix(4, 2), 9, 2, 5);
}

TEST_CASE("border: with an empty border a solve has the bits of the inner one") {
  const SymmetricMatrix matrix = mesh_matrix(3000);
  const auto global = GlobalPhase::factor(Exec(2), matrix, *fill_reducing_order(Exec(2), matrix));
  REQUIRE(global);
  const auto bordered = BorderedPhase::factor(Exec(1), *global, {}, {});
  REQUIRE(bordered);
  const std::vector<Vec2> rhs = random_points(matrix.size(), 4);
  std::vector<Vec2> x(rhs.size()), alone(rhs.size());
  bordered->solve(Exec(1), rhs, {}, x, {});
  global->solve(Exec(1), rhs, alone);
  CHECK(x == alone);
}

TEST_CASE("border: the solution is where the energy of its definition has no slope") {
  const SymmetricMatrix matrix = random_matrix(30, 6);
  const auto columns = random_columns(30, 3, 4, 6);
  const RealSystem whole(matrix, columns, 0.5);
  const auto global = GlobalPhase::factor(Exec(2), matrix, *fill_reducing_order(Exec(2), matrix));
  const auto bordered = BorderedPhase::factor(Exec(1), *global, columns, whole.corner);
  REQUIRE(bordered);
  const std::vector<Vec2> f = random_points(30, 7);
  const std::vector<double> g = {0.3, -1, 2};
  std::vector<Vec2> x(30);
  std::vector<double> y(3);
  bordered->solve(Exec(1), f, g, x, y);
  const Eigen::MatrixXd k = dense(matrix);
  const auto energy = [&](In<Vec2> at, In<double> border) {
    double sum = 0;
    for (Index i = 0; i < 30; ++i) {
      for (Index j = 0; j < 30; ++j) sum += 0.5 * k(i, j) * dot(at[i], at[j]);
      sum -= dot(f[i], at[i]);
    }
    for (Index a = 0; a < 3; ++a) {
      for (std::size_t e = 0; e < columns[a].row.size(); ++e)
        sum += border[a] * dot(at[columns[a].row[e]], columns[a].value[e]);
      for (Index b = 0; b < 3; ++b) sum += 0.5 * border[a] * whole.corner[3 * a + b] * border[b];
      sum -= g[a] * border[a];
    }
    return sum;
  };
  const double step = 1e-3;
  for (Index i = 0; i < 30; i += 7) {
    std::vector<Vec2> ahead = x, behind = x;
    ahead[i].y += step, behind[i].y -= step;
    CHECK(std::abs(energy(ahead, y) - energy(behind, y)) < 1e-10);
  }
  for (Index a = 0; a < 3; ++a) {
    std::vector<double> ahead = y, behind = y;
    ahead[a] += step, behind[a] -= step;
    CHECK(std::abs(energy(x, ahead) - energy(x, behind)) < 1e-10);
  }
}

TEST_CASE("border: 1, 2 and 7 threads give the same bits") {
  const SymmetricMatrix matrix = mesh_matrix(20000);
  const auto global = GlobalPhase::factor(Exec(2), matrix, *fill_reducing_order(Exec(2), matrix));
  REQUIRE(global);
  const Index m = 40;
  const auto columns = random_columns(matrix.size(), m, 10, 2);
  std::vector<double> corner(static_cast<std::size_t>(m) * m, 0);
  for (Index j = 0; j < m; ++j) corner[j * m + j] = 1e4;
  const std::vector<Vec2> rhs = random_points(matrix.size(), 3);
  const std::vector<double> rhs_border(m, 0.5);
  const auto solve = [&](int threads) {
    const Exec exec(threads);
    auto bordered = BorderedPhase::factor(exec, *global, columns, corner);
    REQUIRE(bordered);
    std::pair<std::vector<Vec2>, std::vector<double>> result(rhs.size(), m);
    bordered->solve(exec, rhs, rhs_border, result.first, result.second);
    return result;
  };
  const auto one = solve(1);
  CHECK(solve(2) == one);
  CHECK(solve(7) == one);
}

TEST_CASE("border: a corner that is too small for its columns is refused as not positive definite") {
  const SymmetricMatrix matrix = random_matrix(20, 3);
  const auto columns = random_columns(20, 2, 5, 3);
  const auto global = GlobalPhase::factor(Exec(2), matrix, *fill_reducing_order(Exec(2), matrix));
  const auto bordered =
      BorderedPhase::factor(Exec(1), *global, columns, RealSystem(matrix, columns, -1e-3).corner);
  REQUIRE_FALSE(bordered);
  CHECK(bordered.error().code == ErrorCode::FactorizationFailed);
}

TEST_CASE("global phase: the first half of a solve is the same for a sparse column and for a full one") {
  for (const Index triangles : {50, 3000, 60000}) {
    const SymmetricMatrix matrix = mesh_matrix(triangles);
    const auto global = GlobalPhase::factor(Exec(2), matrix, *fill_reducing_order(Exec(2), matrix));
    REQUIRE(global);
    std::vector<SparseColumn> columns = random_columns(matrix.size(), 20, 1, 5);
    for (SparseColumn& more : random_columns(matrix.size(), 20, 12, 6)) columns.push_back(std::move(more));
    columns.emplace_back();  // and none at all
    const std::vector<SparseColumn> half = global->forward(Exec(2), columns);
    REQUIRE(half.size() == columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
      std::vector<Vec2> rhs(matrix.size()), expected(matrix.size()), found(matrix.size());
      for (std::size_t i = 0; i < columns[k].row.size(); ++i) rhs[columns[k].row[i]] = columns[k].value[i];
      global->forward(Exec(2), rhs, expected);
      CHECK(std::is_sorted(half[k].row.begin(), half[k].row.end()));
      for (std::size_t i = 0; i < half[k].row.size(); ++i) found[half[k].row[i]] = half[k].value[i];
      double worst = 0;
      for (Index i = 0; i < matrix.size(); ++i) worst = std::max(worst, norm(found[i] - expected[i]));
      CHECK(worst < 1e-14);
    }
  }
}

TEST_CASE("global phase: the two halves in turn are a solve") {
  const SymmetricMatrix matrix = mesh_matrix(5000);
  const auto global = GlobalPhase::factor(Exec(2), matrix, *fill_reducing_order(Exec(2), matrix));
  REQUIRE(global);
  const std::vector<Vec2> rhs = random_points(matrix.size(), 8);
  std::vector<Vec2> half(rhs.size()), x(rhs.size()), whole(rhs.size());
  global->forward(Exec(2), rhs, half);
  global->backward(Exec(2), half, x);
  global->solve(Exec(2), rhs, whole);
  CHECK(x == whole);
}
