#include "kernels/sparse/strip_panel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "tests/support/instruction_sets.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// A panel as a Laplacian's factor has them: negative entries below the diagonal, that stretch the columns differently.
struct Strips {
  std::vector<double> value;
  std::vector<std::int16_t> entry;
  std::vector<float> scale, diagonal, inverse;
  Index columns, rows;

  Strips(Index num_columns, Index num_rows, shapes::Random& random)
      : value(num_columns * num_rows), columns(num_columns), rows(num_rows) {
    for (Index j = 0; j < columns; ++j) {
      const double size = std::exp(12 * random.uniform());
      for (Index i = j; i < rows; ++i) at(i, j) = i == j ? size : -size * random.uniform() / (rows - j);
    }
    entry.assign(strips_size(columns, rows), 99);
    for (std::vector<float>* numbers : {&scale, &diagonal, &inverse})
      numbers->resize(columns + kStripColumns);
    std::vector<double> scratch(rows + kStripRows);
    make_strips({columns, rows, value.data()}, entry.data(), {scale.data(), diagonal.data(), inverse.data()},
                scratch.data());
  }

  double& at(Index i, Index j) { return value[static_cast<std::size_t>(j) * rows + i]; }
  StripPanel panel() const {
    return {columns, rows, entry.data(), {scale.data(), diagonal.data(), inverse.data()}};
  }
};

struct AlignedScratch {
  explicit AlignedScratch(Index rows) : room(strip_scratch(rows) + 16) {
    void* begin = room.data();
    std::size_t space = room.size() * sizeof(float);
    value = static_cast<float*>(std::align(64, strip_scratch(rows) * sizeof(float), begin, space));
  }
  std::vector<float> room;
  float* value = nullptr;
};

/// Places of the rows: own columns one behind the other, those below scattered behind them.
std::vector<Index> scattered_rows(const Strips& s, Index first) {
  std::vector<Index> row(s.rows);
  for (Index i = 0; i < s.rows; ++i)
    row[i] = first + (i < s.columns ? i : s.columns + 3 * (i - s.columns) + 1);
  return row;
}

std::vector<FloatVec2> random_points(std::size_t n, shapes::Random& random) {
  std::vector<FloatVec2> y(n);
  for (FloatVec2& z : y)
    z = {static_cast<float>(random.uniform() - 0.5), static_cast<float>(random.uniform() - 0.5)};
  return y;
}

template <class Body>
void for_all_sizes(Body&& body) {
  for (const Index columns : {1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 24, 30}) {
    for (const Index below : {0, 1, 5, 7, 8, 9, 16, 23}) body(columns, columns + below);
  }
}

}  // namespace

TEST_CASE(
    "strip panel: forward solves with the triangle and takes from the rows below, to 16 bits, every "
    "instruction set") {
  shapes::Random random(21);
  for (const InstructionSet set : available_sets()) {
    for_all_sizes([&](Index columns, Index rows) {
      Strips s(columns, rows, random);
      const std::vector<Index> row = scattered_rows(s, 2);
      const std::vector<FloatVec2> before = random_points(row.back() + 20, random);
      std::vector<FloatVec2> y = before;
      AlignedScratch scratch(rows);
      const Index inside = (rows - columns) / 2;
      strip_solves(set).forward(s.panel(), row.data(), inside, y.data(), scratch.value);
      double worst = 0;
      std::vector<double> u(columns), v(columns);
      for (Index i = 0; i < rows; ++i) {
        double x = i < columns ? before[row[i]].x : 0.0, z = i < columns ? before[row[i]].y : 0.0;
        for (Index j = 0; j < std::min(columns, i); ++j) x -= s.at(i, j) * u[j], z -= s.at(i, j) * v[j];
        if (i < columns) {
          u[i] = x /= s.at(i, i), v[i] = z /= s.at(i, i);
          worst = std::max(
              {worst, s.at(i, i) * std::abs(y[row[i]].x - x), s.at(i, i) * std::abs(y[row[i]].y - z)});
          continue;
        }
        const FloatVec2 got = i < columns + inside
                                  ? FloatVec2{y[row[i]].x - before[row[i]].x, y[row[i]].y - before[row[i]].y}
                                  : FloatVec2{scratch.value[2 * i], scratch.value[2 * i + 1]};
        worst = std::max({worst, std::abs(got.x - x), std::abs(got.y - z)});
      }
      CHECK(worst < 5e-5);
      // Nothing else is touched.
      std::vector<std::uint8_t> may_change(y.size());
      for (Index i = 0; i < columns + inside; ++i) may_change[row[i]] = 1;
      for (std::size_t i = 0; i < y.size(); ++i)
        CHECK((may_change[i] || (y[i].x == before[i].x && y[i].y == before[i].y)));
    });
  }
}

TEST_CASE("strip panel: backward is the transpose of forward, every instruction set") {
  shapes::Random random(22);
  for (const InstructionSet set : available_sets()) {
    for_all_sizes([&](Index columns, Index rows) {
      const Strips s(columns, rows, random);
      std::vector<Index> row(rows);
      std::iota(row.begin(), row.end(), 0);
      AlignedScratch scratch(rows);
      // forward a = F a, backward b = F^T b, on all rows: a . F^T b = F a . b
      const std::vector<FloatVec2> a = random_points(rows, random), b = random_points(rows, random);
      std::vector<FloatVec2> forward = a, backward = b;
      strip_solves(set).forward(s.panel(), row.data(), rows - columns, forward.data(), scratch.value);
      strip_solves(set).backward(s.panel(), row.data(), backward.data(), scratch.value);
      double x = 0, y = 0;
      for (Index i = 0; i < rows; ++i) {
        x += double{a[i].x} * backward[i].x - double{forward[i].x} * b[i].x;
        y += double{a[i].y} * backward[i].y - double{forward[i].y} * b[i].y;
      }
      CHECK(std::abs(x) < 1e-5);
      CHECK(std::abs(y) < 1e-5);
      for (Index i = columns; i < rows; ++i) CHECK((backward[i].x == b[i].x && backward[i].y == b[i].y));
    });
  }
}

TEST_CASE(
    "strip panel: what a strip makes of a constant is exact to single precision, for rounding keeps the sums "
    "of columns") {
  shapes::Random random(23);
  for (Index columns = 1; columns <= kStripColumns; ++columns) {
    for (const Index below : {0, 1, 6, 20, 50}) {
      Strips s(columns, columns + below, random);
      std::vector<Index> row(s.rows);
      std::iota(row.begin(), row.end(), 0);
      AlignedScratch scratch(s.rows);
      std::vector<FloatVec2> y(s.rows, {1, 1});
      for (Index j = 0; j < columns; ++j) y[j].x = y[j].y = static_cast<float>(s.at(j, j));
      strip_solves(InstructionSet::Baseline).backward(s.panel(), row.data(), y.data(), scratch.value);
      std::vector<double> x(s.rows, 1.0);
      for (Index j = columns; j-- > 0;) {
        for (Index i = j + 1; i < s.rows; ++i) x[j] -= s.at(i, j) * x[i] / s.at(j, j);
        CHECK(std::abs(y[j].x - x[j]) < 2e-6 * x[j]);
      }
    }
  }
}
