#include "kernels/sparse/supernode.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "tests/support/instruction_sets.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

struct RandomPanel {
  Panel panel;
  std::vector<double> value;

  RandomPanel(Index columns, Index rows, shapes::Random& random) : value(columns * rows) {
    for (double& x : value) x = random.uniform() - 0.5;
    for (Index j = 0; j < columns; ++j) value[j * rows + j] += 2;
    panel = {columns, rows, value.data()};
  }
  double at(Index i, Index j) const { return value[j * panel.rows + i]; }
};

}  // namespace

TEST_CASE(
    "supernode: forward and backward invert the lower triangle and apply the rows below, every instruction "
    "set") {
  shapes::Random random(11);
  for (const InstructionSet set : available_sets()) {
    const PanelSolves& solves = panel_solves(set);
    for (const Index columns : {1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 16, 23}) {
      for (const Index below : {0, 1, 2, 3, 4, 7, 8, 9, 15, 16, 17, 30}) {
        const RandomPanel p(columns, columns + below, random);
        std::vector<double> u(p.panel.rows), v(p.panel.rows);
        for (double& x : u) x = random.uniform();
        for (Index i = columns; i < p.panel.rows; ++i) u[i] = 0;
        for (Index i = 0; i < p.panel.rows; ++i) v[i] = -2 * u[i];
        const std::vector<double> rhs = u;
        solves.forward(p.panel, u.data(), v.data());
        double worst = 0;
        for (Index i = 0; i < p.panel.rows; ++i) {  // L times the result, rows below: minus the result
          double product = 0;
          for (Index j = 0; j < std::min<Index>(columns, i + 1); ++j) product += p.at(i, j) * u[j];
          worst = std::max(
              {worst, std::abs(i < columns ? product - rhs[i] : product + u[i]), std::abs(v[i] + 2 * u[i])});
        }
        CHECK(worst < 1e-12);
        std::vector<double> x(p.panel.rows), y(p.panel.rows, 0);
        for (double& value : x) value = random.uniform();
        const std::vector<double> before = x;
        solves.backward(p.panel, x.data(), y.data());
        worst = 0;
        for (Index j = 0; j < columns; ++j) {  // the transpose
          double product = 0;
          for (Index i = j; i < p.panel.rows; ++i) product += p.at(i, j) * x[i];
          worst = std::max({worst, std::abs(product - before[j]), std::abs(y[j])});
        }
        for (Index i = columns; i < p.panel.rows; ++i) worst = std::max(worst, std::abs(x[i] - before[i]));
        CHECK(worst < 1e-12);
      }
    }
  }
}
