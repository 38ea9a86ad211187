#include "engine/methods/angle_border.hpp"

#include <algorithm>
#include <Eigen/Dense>

namespace planish {
namespace {

/// Rows that follow from others get multipliers of least norm; they must not contradict them.
/// scale: of each row before the sparse part is eliminated.
Result<Eigen::VectorXd> independent(const Eigen::MatrixXd& schur, const Eigen::VectorXd& scale,
                                    const Eigen::VectorXd& rhs, In<LongAngleRow> long_rows, bool exact) {
  constexpr double kDependent = 1e-9, kContradiction = 1e-7;
  const Eigen::MatrixXd scaled = scale.asDiagonal() * schur * scale.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(kDependent);
  solver.compute(scaled);
  const Eigen::VectorXd y = scale.asDiagonal() * solver.solve(scale.asDiagonal() * rhs);
  const Eigen::VectorXd gap = schur * y - rhs;
  Error error{.code = exact ? ErrorCode::FactorizationFailed : ErrorCode::ConstraintsConflict,
              .what = "angles contradict one another"};
  for (Index k = 0; k < gap.size(); ++k) {
    if (!(std::abs(gap[k]) <= kContradiction)) error.ids.push_back(long_rows[k].relation);
  }
  error.count = static_cast<Offset>(error.ids.size());
  if (error.count > 0) return fail(error);
  return y;
}

}  // namespace

Result<void> solve_bordered(const AngleBlocks& blocks, const AngleFactor& factor, In<LongAngleRow> long_rows,
                            bool exact, std::vector<Vec2>& x, Out<double> long_multiplier) {
  factor.solve(x);
  const Index num_rows = blocks.num_rows();
  const auto m = static_cast<Index>(long_multiplier.size());
  if (m == 0) return {};
  std::vector<std::vector<Vec2>> columns;  // A^-1 B, two columns at a time
  Eigen::MatrixXd schur(m, m);
  Eigen::VectorXd rhs(m), scale(m);
  std::vector<std::vector<double>> border;  // B by rows of the sparse part
  std::vector<std::vector<double>> pushed;  // P g by corner
  for (const LongAngleRow& row : long_rows) {
    pushed.push_back(blocks.projected(row));
    border.push_back(blocks.in_rows(pushed.back()));
  }
  for (Index k = 0; k < m; k += 2) {
    std::vector<Vec2> pair(num_rows);
    for (Index j = 0; j < num_rows; ++j) pair[j] = {border[k][j], k + 1 < m ? border[k + 1][j] : 0};
    factor.solve(pair);
    columns.push_back(std::move(pair));
  }
  const auto column = [&](Index k, Index j) {
    return k % 2 == 0 ? columns[k / 2][j].x : columns[k / 2][j].y;
  };
  std::vector<double> plain(blocks.num_corners());
  for (Index c = 0; c < blocks.num_corners(); c += 3) {
    const AngleBlocks::Triple step = blocks.plain_step(c);
    std::copy(step.begin(), step.end(), plain.begin() + c);
  }
  for (Index k = 0; k < m; ++k) {
    const LongAngleRow& row = long_rows[k];
    rhs[k] = along(row, blocks.angle()) - row.target + along(row, plain);
    for (Index j = 0; j < num_rows; ++j) rhs[k] -= border[k][j] * x[j].x;
    for (Index l = 0; l < m; ++l) {
      schur(k, l) = along(row, pushed[l]);
      if (l == k) scale[k] = 1 / std::sqrt(std::abs(schur(k, k)));
      for (Index j = 0; j < num_rows; ++j) schur(k, l) -= border[k][j] * column(l, j);
    }
  }
  auto y = independent(schur, scale, rhs, long_rows, exact);
  if (!y) return fail(y.error());
  for (Index k = 0; k < m; ++k) {
    long_multiplier[k] = (*y)[k];
    for (Index j = 0; j < num_rows; ++j) x[j].x -= column(k, j) * (*y)[k];
  }
  return {};
}

double along(const LongAngleRow& row, In<double> values) {
  double sum = 0;
  for (const LongAngleRow::Term& term : row.terms) sum += term.factor * values[term.corner];
  return sum;
}

}  // namespace planish
