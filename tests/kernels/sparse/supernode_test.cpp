#include "kernels/sparse/supernode.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

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
    "supernode: forward and backward panels invert the lower triangle and apply the rows below, all shapes") {
  shapes::Random random(11);
  for (Index columns = 1; columns <= 9; ++columns) {
    for (Index below = 0; below <= 11; ++below) {
      const RandomPanel p(columns, columns + below, random);
      std::vector<double> u(p.panel.rows), v(p.panel.rows);
      for (double& x : u) x = random.uniform();
      for (double& x : v) x = random.uniform();
      for (Index i = columns; i < p.panel.rows; ++i) u[i] = v[i] = 0;
      const std::vector<double> rhs = u;
      forward_panel(p.panel, u, v);
      for (Index i = 0; i < p.panel.rows; ++i) {  // L times the result, rows below: minus the result
        double product = 0;
        for (Index j = 0; j < std::min<Index>(columns, i + 1); ++j) product += p.at(i, j) * u[j];
        CHECK((i < columns ? product - rhs[i] : product + u[i]) == Approx(0));
      }
      std::vector<double> x(p.panel.rows), y(p.panel.rows, 0);
      for (double& value : x) value = random.uniform();
      const std::vector<double> before = x;
      backward_panel(p.panel, x, y);
      for (Index j = 0; j < columns; ++j) {  // the transpose
        double product = 0;
        for (Index i = j; i < p.panel.rows; ++i) product += p.at(i, j) * x[i];
        CHECK(product == Approx(before[j]));
        CHECK(y[j] == 0);
      }
    }
  }
}

TEST_CASE("supernode: a panel in single precision gives the bits of its values in double, all shapes") {
  shapes::Random random(12);
  for (Index columns = 1; columns <= 9; ++columns) {
    for (Index below = 0; below <= 11; ++below) {
      RandomPanel p(columns, columns + below, random);
      std::vector<float> rounded(p.value.begin(), p.value.end());
      p.value.assign(rounded.begin(), rounded.end());
      const FloatPanel single{columns, columns + below, rounded.data()};
      std::vector<double> u(p.panel.rows), v(p.panel.rows);
      for (double& x : u) x = random.uniform();
      for (double& x : v) x = random.uniform();
      std::vector<double> u_single = u, v_single = v;
      forward_panel(p.panel, u, v);
      forward_panel(single, u_single, v_single);
      CHECK(u == u_single);
      CHECK(v == v_single);
      backward_panel(p.panel, u, v);
      backward_panel(single, u_single, v_single);
      CHECK(u == u_single);
      CHECK(v == v_single);
    }
  }
}
