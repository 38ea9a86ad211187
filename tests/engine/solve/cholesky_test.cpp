#include <Eigen/SparseCholesky>
#include <doctest/doctest.h>

#include <numeric>

#include "engine/solve/cholesky_analysis.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/solve/twin_rows.hpp"
#include "tests/support/cholmod_reference.hpp"
#include "tests/support/sparse_cases.hpp"

using namespace planish;

namespace {

std::vector<Index> natural(Index n) {
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::vector<Vec2> random_rhs(Index n, shapes::Random& random) {
  std::vector<Vec2> rhs(n);
  for (Vec2& b : rhs) b = {random.uniform() - 0.5, random.uniform() - 0.5};
  return rhs;
}

/// Largest |A x - b| over |A| |x| + |b|, row by row: the relative residual that a stable method keeps small however ill
/// conditioned the matrix is.
double relative_residual(const SymmetricMatrix& a, In<Vec2> x, In<Vec2> b) {
  std::vector<Vec2> r(b.begin(), b.end());
  std::vector<double> scale(b.size());
  for (std::size_t i = 0; i < b.size(); ++i) scale[i] = norm(b[i]);
  const auto add = [&](Index i, Index j, double value) {
    r[i] = r[i] - value * x[j];
    scale[i] += std::abs(value) * norm(x[j]);
  };
  for (Index j = 0; j < a.size(); ++j) {
    for (Index k = a.column_begin[j]; k < a.column_begin[j + 1]; ++k) {
      add(a.row[k], j, a.value[k]);
      if (a.row[k] != j) add(j, a.row[k], a.value[k]);
    }
  }
  double worst = 0;
  for (std::size_t i = 0; i < r.size(); ++i) worst = std::max(worst, norm(r[i]) / std::max(scale[i], 1e-300));
  return worst;
}

/// Weights from 1e-8 to 1e8 on a grid.
SymmetricMatrix ill_conditioned(Index width, shapes::Random& random) {
  std::set<std::pair<Index, Index>> edges;
  for (Index v = 0; v < width * width; ++v) {
    if (v % width > 0) edges.insert({v, v - 1});
    if (v >= width) edges.insert({v, v - width});
  }
  SymmetricMatrix matrix = sparse_cases::from_edges(width * width, edges, random, 1e-9);
  std::vector<double> diagonal(matrix.size(), 1e-9);
  for (Index j = 0; j < matrix.size(); ++j) {
    for (Index k = matrix.column_begin[j] + 1; k < matrix.column_begin[j + 1]; ++k) {
      matrix.value[k] = -std::pow(10, 16 * random.uniform() - 8);
      diagonal[j] -= matrix.value[k], diagonal[matrix.row[k]] -= matrix.value[k];
    }
  }
  for (Index j = 0; j < matrix.size(); ++j) matrix.value[matrix.column_begin[j]] = diagonal[j];
  return matrix;
}

struct Case {
  const char* name;
  SymmetricMatrix matrix;
};

std::vector<Case> all_cases() {
  shapes::Random random(61);
  std::vector<Case> cases;
  cases.push_back({"one row", sparse_cases::from_edges(1, {}, random)});
  cases.push_back({"diagonal", sparse_cases::from_edges(3000, {}, random)});
  cases.push_back({"disconnected", sparse_cases::random_matrix(4000, 1, random)});
  cases.push_back({"random", sparse_cases::random_matrix(600, 7, random)});
  cases.push_back({"ill conditioned", ill_conditioned(90, random)});
  std::set<std::pair<Index, Index>> path, dense, clique;
  for (Index k = 1; k < 4000; ++k) path.insert({k, k - 1});
  dense = path;
  for (Index k = 2; k < 4000; ++k) dense.insert({k, 0});
  for (Index a = 0; a < 250; ++a) {
    for (Index b = 0; b < a; ++b) clique.insert({a, b});
  }
  cases.push_back({"path", sparse_cases::from_edges(4000, path, random)});
  cases.push_back({"dense column", sparse_cases::from_edges(4000, dense, random)});
  cases.push_back({"clique", sparse_cases::from_edges(250, clique, random)});
  return cases;
}

}  // namespace

TEST_CASE("cholesky: residuals below 1e-12, the solutions of CHOLMOD and Eigen where they can agree") {
  for (const Case& c : all_cases()) {
    CAPTURE(c.name);
    shapes::Random random(62);
    const std::vector<Vec2> rhs = random_rhs(c.matrix.size(), random);
    for (const auto& order : {natural(c.matrix.size()), *fill_reducing_order(Exec(2), c.matrix)}) {
      if (c.matrix.size() > 700 && order == natural(c.matrix.size()) && std::string(c.name) == "dense column")
        continue;
      const auto global = GlobalPhase::factor(Exec(2), c.matrix, order);
      REQUIRE(global);
      std::vector<Vec2> x(rhs.size());
      global->solve(Exec(2), rhs, x);
      CHECK(relative_residual(c.matrix, x, rhs) < 1e-12);
      if (std::string(c.name) == "ill conditioned") continue;
      CholmodReference cholmod(c.matrix, order);
      REQUIRE(cholmod.factor());
      const std::vector<Vec2> expected = cholmod.solve(rhs);
      Eigen::SparseMatrix<double> eigen = Eigen::Map<const Eigen::SparseMatrix<double>>(
          c.matrix.size(), c.matrix.size(), static_cast<Eigen::Index>(c.matrix.row.size()),
          c.matrix.column_begin.data(), c.matrix.row.data(), c.matrix.value.data());
      const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> llt(eigen);
      Eigen::VectorXd b(c.matrix.size());
      for (Index i = 0; i < c.matrix.size(); ++i) b[i] = rhs[i].x;
      const Eigen::VectorXd by_eigen = llt.solve(b);
      double worst = 0, size = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        worst = std::max(
            {worst, norm(x[i] - expected[i]), std::abs(x[i].x - by_eigen[static_cast<Eigen::Index>(i)])});
        size = std::max(size, norm(expected[i]));
      }
      CHECK(worst < 1e-10 * size);
    }
  }
}

TEST_CASE("cholesky: a matrix without rows has a factor") {
  const SymmetricMatrix nothing{{0}, {}, {}};
  const auto global = GlobalPhase::factor(Exec(1), nothing, {});
  REQUIRE(global);
  CHECK(global->factor_nonzeros() == 0);
  global->solve(Exec(1), {}, {});
}

namespace {

void check_structure(const SymmetricMatrix& matrix, In<Index> order) {
  const auto a = analyse_cholesky(Exec(2), matrix, order);
  REQUIRE(a);
  CHECK(*count_factor(matrix, order) == a->factor_nonzeros());
  const auto pattern = sparse_cases::factor_pattern(matrix, a->permutation);
  std::vector<Index> first(a->num_supernodes());
  for (Index s = 0; s < a->num_supernodes(); ++s) {
    const In<Index> rows = In<Index>(a->row).subspan(a->row_begin[s], a->rows(s));
    std::set<Index> held(rows.begin(), rows.end());
    CHECK(static_cast<Index>(held.size()) == a->rows(s));
    CHECK(std::is_sorted(rows.begin(), rows.end()));
    CHECK(rows.front() == a->super[s]);
    for (Index j = a->super[s]; j < a->super[s + 1]; ++j)
      CHECK(std::includes(held.begin(), held.end(), pattern[j].begin(), pattern[j].end()));
    first[s] = s;
    for (const Index child : a->children(s)) {
      CHECK(a->parent[child] == s);
      first[s] = std::min(first[s], first[child]);
    }
    // The children's subtrees fill the range before s.
    Index end = first[s];
    for (const Index child : a->children(s)) {
      CHECK(first[child] == end);
      end = child + 1;
    }
    CHECK(end == s);
  }
  CHECK(a->super.back() == matrix.size());
}

/// Rows of one or two for each of a matrix, the two coupled; what couples rows of it couples all of theirs, but for some
/// entries that are left out.
SymmetricMatrix in_pairs(const SymmetricMatrix& matrix, In<Index> first, shapes::Random& random,
                         double left_out) {
  std::set<std::pair<Index, Index>> edges;
  for (Index j = 0; j < matrix.size(); ++j) {
    for (Index k = matrix.column_begin[j]; k < matrix.column_begin[j + 1]; ++k) {
      const Index i = matrix.row[k];
      for (Index a = first[i]; a < first[i + 1]; ++a) {
        for (Index b = first[j]; b < first[j + 1]; ++b) {
          if (a > b && random.uniform() >= left_out) edges.insert({a, b});
        }
      }
    }
  }
  return sparse_cases::from_edges(first[matrix.size()], edges, random);
}

}  // namespace

TEST_CASE("cholesky: supernodes are postordered, hold the factor's structure, and cost the memory foretold") {
  for (const Case& c : all_cases()) {
    CAPTURE(c.name);
    check_structure(c.matrix, *fill_reducing_order(Exec(1), c.matrix));
  }
}

TEST_CASE("cholesky: rows in pairs, some of them torn apart, have the structure of rows one by one") {
  shapes::Random random(67);
  for (const double left_out : {0.0, 0.03}) {
    const SymmetricMatrix of = sparse_cases::random_matrix(800, 3, random);
    std::vector<Index> first{0}, order;
    for (Index i = 0; i < of.size(); ++i) first.push_back(first.back() + (i % 7 == 3 ? 1 : 2));
    const SymmetricMatrix matrix = in_pairs(of, first, random, left_out);
    const std::vector<Index> order_of = *fill_reducing_order(Exec(1), of);
    for (const Index i : order_of) {
      for (Index row = first[i]; row < first[i + 1]; ++row) order.push_back(row);
    }
    check_structure(matrix, order);
    const auto twins = find_twin_rows(matrix, order);
    REQUIRE(twins);
    if (left_out == 0) {
      CHECK(twins->first == first);
      CHECK(twins->pattern.row == of.row);
      // Turned round, the second of a pair comes before the first: all stand alone.
      std::reverse(order.begin(), order.end());
      CHECK(!find_twin_rows(matrix, order));
      check_structure(matrix, order);
    } else {
      CHECK(twins->order.size() > 900);
      CHECK(twins->order.size() < order.size());
    }
  }
}

TEST_CASE(
    "cholesky: factoring again with other values is factoring them anew, bit for bit, any number of "
    "threads") {
  shapes::Random random(63);
  SymmetricMatrix matrix = ill_conditioned(150, random);
  const auto order = *fill_reducing_order(Exec(2), matrix);
  auto again = GlobalPhase::factor(Exec(2), matrix, order);
  for (double& value : matrix.value) value *= 1.5;
  for (Index j = 0; j < matrix.size(); j += 7) matrix.value[matrix.column_begin[j]] *= 1.25;
  const std::vector<Vec2> rhs = random_rhs(matrix.size(), random);
  REQUIRE(again->refactor(Exec(2), matrix));
  std::vector<Vec2> expected(rhs.size());
  again->solve(Exec(2), rhs, expected);
  for (const int threads : {1, 2, 7}) {
    const auto anew = GlobalPhase::factor(Exec(threads), matrix, order);
    std::vector<Vec2> x(rhs.size());
    anew->solve(Exec(threads), rhs, x);
    CHECK(x == expected);
  }
}

TEST_CASE(
    "cholesky: of several bad pivots the first in the order of elimination is named, any number of threads") {
  shapes::Random random(64);
  SymmetricMatrix matrix = sparse_cases::random_matrix(6000, 3, random);
  const auto order = *fill_reducing_order(Exec(2), matrix);
  const auto analysis = analyse_cholesky(Exec(1), matrix, order);
  const auto break_at = [&](Index place) {
    matrix.value[matrix.column_begin[analysis->permutation[place]]] = -1e4;
  };
  for (const Index place : {5990, 4000, 1500, 3}) {
    break_at(place);
    for (const int threads : {1, 2, 7}) {
      const auto factored = GlobalPhase::factor(Exec(threads), matrix, order);
      REQUIRE_FALSE(factored);
      CHECK(factored.error().code == ErrorCode::FactorizationFailed);
      CHECK(factored.error().ids == std::vector<Index>{analysis->permutation[place]});
    }
  }
}

TEST_CASE("cholesky: after a failure a definite matrix of the pattern can be factored") {
  shapes::Random random(65);
  const SymmetricMatrix good = sparse_cases::random_matrix(2000, 4, random);
  SymmetricMatrix bad = good;
  bad.value[bad.column_begin[1000]] = -1e4;
  const auto order = *fill_reducing_order(Exec(2), good);
  auto global = GlobalPhase::factor(Exec(2), good, order);
  CHECK_FALSE(global->refactor(Exec(2), bad));
  REQUIRE(global->refactor(Exec(2), good));
  const std::vector<Vec2> rhs = random_rhs(good.size(), random);
  std::vector<Vec2> x(rhs.size());
  global->solve(Exec(2), rhs, x);
  CHECK(relative_residual(good, x, rhs) < 1e-12);
}
