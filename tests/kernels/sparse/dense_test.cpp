#include "kernels/sparse/dense.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "kernels/sparse/extend_add.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// Column-major numbers with rows below and a column behind that must stay as they are.
struct Guarded {
  Index rows, columns, stride;
  std::vector<double> value;
  static constexpr double kGuard = -777;

  Guarded(Index r, Index c, shapes::Random& random)
      : rows(r), columns(c), stride(r + 3), value(static_cast<std::size_t>(stride) * (c + 1), kGuard) {
    for (Index j = 0; j < c; ++j) {
      for (Index i = 0; i < r; ++i) at(i, j) = random.uniform() - 0.5;
    }
  }
  double& at(Index i, Index j) { return value[i + static_cast<std::size_t>(j) * stride]; }
  ColumnMajor view() { return {value.data(), stride}; }
  bool is_guarded() {
    for (Index j = 0; j <= columns; ++j) {
      for (Index i = j < columns ? rows : 0; i < stride; ++i) {
        if (at(i, j) != kGuard) return false;
      }
    }
    return true;
  }
};

/// One step of the chain that every entry is.
double step(InstructionSet set, double a, double b, double c) {
  return set == InstructionSet::Baseline ? c - a * b : std::fma(-a, b, c);
}

/// The scalar twin: column by column, left-looking.
Index factor_plainly(InstructionSet set, Guarded& p, Index first, Index last, Index rows) {
  for (Index j = first; j < last; ++j) {
    for (Index i = j; i < rows; ++i) {
      for (Index k = first; k < j; ++k) p.at(i, j) = step(set, p.at(i, k), p.at(j, k), p.at(i, j));
    }
    if (!(p.at(j, j) > 0)) return j;
    p.at(j, j) = std::sqrt(p.at(j, j));
    const double inverse = 1 / p.at(j, j);
    for (Index i = j + 1; i < rows; ++i) p.at(i, j) *= inverse;
  }
  return kNone;
}

bool same_lower(Guarded& a, Guarded& b, Index first, Index last) {
  for (Index j = first; j < last; ++j) {
    for (Index i = j; i < a.rows; ++i) {
      if (a.at(i, j) != b.at(i, j)) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("dense: panels are factored with the bits of the scalar twin, all shapes, every instruction set") {
  shapes::Random random(31);
  for (const InstructionSet set : available_sets()) {
    const DenseKernels& kernels = dense_kernels(set);
    for (const Index columns : {1, 2, 3, 4, 5, 7, 8, 9, 13, 16, 31, 64}) {
      for (const Index below : {0, 1, 2, 5, 8, 11, 23, 24, 25, 49, 77}) {
        Guarded panel(columns + below + 2, columns + 2, random);
        const Index first = 2, last = columns + 2;  // columns before the first are not looked at
        for (Index j = 0; j < last; ++j) panel.at(j, j) += 0.3 * columns + 1;
        Guarded expected = panel;
        CHECK(kernels.factor_columns(panel.view(), first, last, panel.rows) == kNone);
        CHECK(factor_plainly(set, expected, first, last, panel.rows) == kNone);
        CHECK(same_lower(panel, expected, first, last));
        CHECK(panel.is_guarded());
      }
    }
  }
}

TEST_CASE("dense: a panel solved for in parts has the same bits as at once") {
  shapes::Random random(32);
  for (const InstructionSet set : available_sets()) {
    const DenseKernels& kernels = dense_kernels(set);
    Guarded whole(90, 21, random);
    for (Index j = 0; j < 21; ++j) whole.at(j, j) += 9;
    Guarded parts = whole;
    kernels.factor_columns(whole.view(), 0, 21, 90);
    kernels.factor_columns(parts.view(), 0, 21, 21);
    for (const Range r : {Range{21, 22}, Range{22, 60}, Range{60, 60}, Range{60, 90}})
      kernels.solve_rows(parts.view(), 0, 21, r);
    CHECK(same_lower(whole, parts, 0, 21));
    CHECK(parts.is_guarded());
  }
}

TEST_CASE("dense: the first pivot that is not positive is named, a number that is none too") {
  shapes::Random random(33);
  for (const InstructionSet set : available_sets()) {
    for (const Index bad : {0, 3, 8, 14, 19}) {
      for (const double value : {-5.0, 0.0, std::nan("")}) {
        Guarded panel(30, 20, random);
        for (Index j = 0; j < 20; ++j) panel.at(j, j) += 9;
        for (Index j = 0; j < bad; ++j) panel.at(bad, j) = 0;
        panel.at(bad, bad) = value;
        CHECK(dense_kernels(set).factor_columns(panel.view(), 0, 20, 30) == bad);
      }
    }
  }
}

TEST_CASE("dense: products are subtracted with the bits of the scalar twin, fresh or not, lower or whole") {
  shapes::Random random(34);
  for (const InstructionSet set : available_sets()) {
    const DenseKernels& kernels = dense_kernels(set);
    for (const Index m : {1, 3, 8, 17, 24, 50}) {
      for (const Index n : {1, 4, 7, 8, 13}) {
        for (const Index k : {0, 1, 5, 40, 300}) {
          for (const bool fresh : {false, true}) {
            for (const bool lower : {false, true}) {
              if (lower && n > m) continue;
              Guarded a(m, k, random), b(n, k, random), c(m, n, random);
              Guarded expected = c;
              kernels.subtract_products(c.view(), a.view(), b.view(), m, n, k, fresh, lower);
              bool same = true;
              for (Index j = 0; j < n; ++j) {
                for (Index i = lower ? j : 0; i < m; ++i) {
                  double sum = fresh ? 0 : expected.at(i, j);
                  for (Index l = 0; l < k; ++l) sum = step(set, a.at(i, l), b.at(j, l), sum);
                  same = same && c.at(i, j) == sum;
                }
              }
              CHECK(same);
              CHECK(c.is_guarded());
            }
          }
        }
      }
    }
  }
}

TEST_CASE("extend add: entries of the lower triangle arrive where the places say, any split of the columns") {
  shapes::Random random(35);
  for (const std::vector<Index>& place :
       {std::vector<Index>{4}, {3, 5, 6}, {2, 3, 4, 5}, {2, 4, 6, 9, 10, 11}, {2, 3, 8, 9, 11}}) {
    const auto m = static_cast<Index>(place.size());
    const Index first = 2, size = 10;
    Guarded update(m, m, random), target(size, size, random);
    Guarded expected = target;
    for (Index j = 0; j < m; ++j) {
      for (Index i = j; i < m; ++i) expected.at(place[i] - first, place[j] - first) += update.at(i, j);
    }
    extend_add(target.view(), first, place, update.view(), {0, m / 2});
    extend_add(target.view(), first, place, update.view(), {m / 2, m});
    CHECK(target.value == expected.value);
  }
}
