#include "engine/methods/angle_system.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <optional>

#include "engine/methods/angle_projection.hpp"
#include "engine/solve/columns.hpp"
#include "engine/solve/global_phase.hpp"

namespace planish {

struct AngleSystem::Parts {
  using Triple = std::array<double, 3>;

  Parts(const Exec& exec, const AngleProblem& problem)
      : exec_(exec),
        problem_(problem),
        rows_(*problem.rows),
        num_corners_(static_cast<Index>(problem.corner_vertex.size())),
        hessian_(num_corners_),
        cotangent_(num_corners_) {
    for (const Index v : problem.order) {
      for (Index r = rows_.of(v).begin; r < rows_.of(v).end; ++r) row_order_.push_back(r);
    }
  }

  Result<void> factor_at(In<double> angle, In<double> multiplier, bool exact) {
    angle_ = angle;
    exact_ = exact;
    find_hessian(multiplier);
    return exact ? factor_indefinite(matrix()) : factor(matrix());
  }

  Index vertex(Index c) const { return problem_.corner_vertex[c]; }

  /// Second derivatives of the Lagrangian by the angles; where a triangle's are not definite they are kept away from 0.
  void find_hessian(In<double> multiplier) {
    exec_.for_blocks(num_corners_ / 3, kBlock, [&](Index, Range r) {
      for (Index c = 3 * r.begin; c < 3 * r.end; ++c) {
        const double sine = std::sin(angle_[c]);
        cotangent_[c] = std::cos(angle_[c]) / sine;
        hessian_[c] = 2 * problem_.weight[c] + (wheel_multiplier(multiplier, vertex(next_corner(c))) -
                                                wheel_multiplier(multiplier, vertex(previous_corner(c)))) /
                                                   (sine * sine);
      }
      for (Index t = r.begin; t < r.end && !exact_; ++t) regularise(t);
    });
  }

  void regularise(Index t) {
    constexpr double kLeast = 0.05;
    const Triple own{2 * problem_.weight[3 * t], 2 * problem_.weight[3 * t + 1],
                     2 * problem_.weight[3 * t + 2]};
    const Projection p = projection(3 * t), q{own};
    const Triple& h = p.h;
    const bool sums_positive = h[0] + h[1] > 0 && h[1] + h[2] > 0 && h[2] + h[0] > 0;
    if (sums_positive && p.determinant() > kLeast * q.determinant()) return;
    for (Index i = 0; i < 3; ++i) hessian_[3 * t + i] = std::max(h[i], kLeast * own[i]);
  }

  double wheel_multiplier(In<double> multiplier, Index v) const {
    const Index row = rows_.wheel(v);
    return row == kNone ? 0 : multiplier[row];
  }

  Projection projection(Index c) const {
    return {{hessian_[c], hessian_[next_corner(c)], hessian_[previous_corner(c)]}};
  }

  /// Derivatives of a row at another corner of the triangle, turned to begin at corner c.
  static Triple turned(const Triple& g, Index from, Index c) {
    const Index shift = (from - c + 3) % 3;
    Triple result;
    for (Index i = 0; i < 3; ++i) result[(i + shift) % 3] = g[i];
    return result;
  }

  SymmetricMatrix matrix() const {
    return gather_columns(exec_, rows_.size(), [&](Range r, ColumnSink& sink) {
      std::vector<Entry> column;
      for (Index j = r.begin; j < r.end; ++j) {
        column.assign(1, {j, 0});
        const Index v = rows_.vertex_of(j);
        for (const Index c :
             slice(In<Index>(problem_.topology->star_corner), problem_.topology->stars().group(v))) {
          const Triple pg = projection(c).apply(rows_.derivatives(j, c, cotangent_));
          for (const Index other : {c, next_corner(c), previous_corner(c)}) {
            const Range theirs = rows_.of(vertex(other));
            for (Index i = std::max(j, theirs.begin); i < theirs.end; ++i) {
              const double value =
                  dot3(pg, turned(rows_.derivatives(i, other, cotangent_), other % 3, c % 3));
              if (i == j) {
                column.front().value += value;
              } else {
                column.push_back({i, value});
              }
            }
          }
        }
        merge_rows(column);
        sink.add(column);
      }
    });
  }

  /// What the step would be without multipliers: minus P q and the triangles' own residuals, shared out.
  Triple plain_step(Index c) const {
    const Projection p = projection(c);
    const std::array<Index, 3> at{c, next_corner(c), previous_corner(c)};
    Triple q;
    double gap = -kPi;
    for (int i = 0; i < 3; ++i) {
      q[i] = 2 * problem_.weight[at[i]] * (angle_[at[i]] - problem_.wanted[at[i]]);
      gap += angle_[at[i]];
    }
    const Triple pushed = p.apply(q), closing = p.spread(gap);
    return {-pushed[0] - closing[0], -pushed[1] - closing[1], -pushed[2] - closing[2]};
  }

  void find_rhs(Out<Vec2> rhs) const {
    exec_.for_blocks(rows_.size(), kBlock, [&](Index, Range r) {
      for (Index j = r.begin; j < r.end; ++j) {
        double sum = rows_.residual(j, angle_);
        for (const Index c : slice(In<Index>(problem_.topology->star_corner),
                                   problem_.topology->stars().group(rows_.vertex_of(j))))
          sum += dot3(rows_.derivatives(j, c, cotangent_), plain_step(c));
        rhs[j] = {sum, 0};
      }
    });
  }

  Result<void> factor(const SymmetricMatrix& a) {
    if (global_) return global_->refactor(exec_, a);
    auto global = GlobalPhase::factor(exec_, a, row_order_);
    if (!global) return fail(global.error());
    global_.emplace(std::move(*global));
    return {};
  }

  /// Without pivoting, so that it may fail.
  Result<void> factor_indefinite(const SymmetricMatrix& a) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < a.size(); ++j) {
      for (Index k = a.column_begin[j]; k < a.column_begin[j + 1]; ++k)
        entries.emplace_back(a.row[k], j, a.value[k]);
    }
    Eigen::SparseMatrix<double> lower(a.size(), a.size());
    lower.setFromTriplets(entries.begin(), entries.end());
    indefinite_.compute(lower);
    return indefinite_.info() == Eigen::Success
               ? Result<void>()
               : fail(ErrorCode::FactorizationFailed, "a pivot of the angles' system is 0");
  }

  void solve_rows(std::vector<Vec2>& x) {
    if (!exact_) return global_->solve(exec_, x, x);
    Eigen::MatrixX2d columns(rows_.size(), 2);
    for (Index j = 0; j < rows_.size(); ++j) columns.row(j) << x[j].x, x[j].y;
    columns = indefinite_.solve(columns).eval();
    for (Index j = 0; j < rows_.size(); ++j) x[j] = {columns(j, 0), columns(j, 1)};
  }

  Result<void> solve(Out<double> multiplier, Out<double> long_multiplier, Out<double> step) {
    std::vector<Vec2> x(rows_.size());
    find_rhs(x);
    if (auto solved = solve_bordered(x, long_multiplier); !solved) return solved;
    for (Index j = 0; j < rows_.size(); ++j) multiplier[j] = x[j].x;
    find_step(multiplier, long_multiplier, step);
    return {};
  }

  void find_step(In<double> multiplier, In<double> long_multiplier, Out<double> step) const {
    std::vector<double> force(num_corners_, 0);  // J^T multipliers, of the rows
    exec_.for_blocks(num_corners_, kBlock, [&](Index, Range r) {
      for (Index c = r.begin; c < r.end; ++c) {
        double sum = 0;
        const std::array<Index, 3> at{c, previous_corner(c),
                                      next_corner(c)};  // c is their own, next, previous
        for (int i = 0; i < 3; ++i) {
          const Range rows = rows_.of(vertex(at[i]));
          for (Index j = rows.begin; j < rows.end; ++j)
            sum += multiplier[j] * rows_.derivatives(j, at[i], cotangent_)[i];
        }
        force[c] = sum;
      }
    });
    for (std::size_t k = 0; k < long_multiplier.size(); ++k) {
      for (const LongAngleRow::Term& term : (*problem_.long_rows)[k].terms)
        force[term.corner] += long_multiplier[k] * term.factor;
    }
    exec_.for_blocks(num_corners_ / 3, kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) {
        const Index c = 3 * t;
        const Triple plain = plain_step(c),
                     pushed = projection(c).apply({force[c], force[c + 1], force[c + 2]});
        for (int i = 0; i < 3; ++i) step[c + i] = plain[i] - pushed[i];
      }
    });
  }

  // ---- long rows: a dense border ----

  using Column = std::vector<std::pair<Index, double>>;  // triangles' corners and P times a long row

  /// P times the gradient of long row k, at all corners of the triangles that it passes.
  Column projected(const LongAngleRow& row) const {
    std::vector<LongAngleRow::Term> terms = row.terms;
    std::sort(terms.begin(), terms.end(), [](const auto& a, const auto& b) { return a.corner < b.corner; });
    Column column;
    for (std::size_t i = 0; i < terms.size();) {
      const Index t = terms[i].corner / 3;
      Triple g{};
      for (; i < terms.size() && terms[i].corner / 3 == t; ++i) g[terms[i].corner % 3] = terms[i].factor;
      const Triple pg = projection(3 * t).apply(g);
      for (Index k = 0; k < 3; ++k) column.emplace_back(3 * t + k, pg[k]);
    }
    return column;
  }

  /// x: the right-hand side in, the multipliers of the rows out.
  Result<void> solve_bordered(std::vector<Vec2>& x, Out<double> long_multiplier) {
    solve_rows(x);
    const auto m = static_cast<Index>(long_multiplier.size());
    if (m == 0) return {};
    std::vector<std::vector<Vec2>> columns;  // A^-1 B, two columns at a time
    Eigen::MatrixXd schur(m, m);
    Eigen::VectorXd rhs(m), scale(m);
    std::vector<std::vector<double>> border;  // B by rows of the sparse part
    std::vector<std::vector<double>> pushed;  // P g by corner
    for (const LongAngleRow& row : *problem_.long_rows) {
      pushed.emplace_back(num_corners_, 0);
      for (const auto& [c, value] : projected(row)) pushed.back()[c] = value;
      border.push_back(in_rows(pushed.back()));
    }
    for (Index k = 0; k < m; k += 2) {
      std::vector<Vec2> pair(rows_.size());
      for (Index j = 0; j < rows_.size(); ++j) pair[j] = {border[k][j], k + 1 < m ? border[k + 1][j] : 0};
      solve_rows(pair);
      columns.push_back(std::move(pair));
    }
    const auto column = [&](Index k, Index j) {
      return k % 2 == 0 ? columns[k / 2][j].x : columns[k / 2][j].y;
    };
    std::vector<double> plain(num_corners_);
    for (Index c = 0; c < num_corners_; c += 3) {
      const Triple step = plain_step(c);
      std::copy(step.begin(), step.end(), plain.begin() + c);
    }
    for (Index k = 0; k < m; ++k) {
      const LongAngleRow& row = (*problem_.long_rows)[k];
      rhs[k] = along(row, angle_) - row.target + along(row, plain);
      for (Index j = 0; j < rows_.size(); ++j) rhs[k] -= border[k][j] * x[j].x;
      for (Index l = 0; l < m; ++l) {
        schur(k, l) = along(row, pushed[l]);
        if (l == k) scale[k] = 1 / std::sqrt(std::abs(schur(k, k)));
        for (Index j = 0; j < rows_.size(); ++j) schur(k, l) -= border[k][j] * column(l, j);
      }
    }
    auto y = independent(schur, scale, rhs);
    if (!y) return fail(y.error());
    for (Index k = 0; k < m; ++k) {
      long_multiplier[k] = (*y)[k];
      for (Index j = 0; j < rows_.size(); ++j) x[j].x -= column(k, j) * (*y)[k];
    }
    return {};
  }

  /// J times a vector over corners.
  std::vector<double> in_rows(In<double> values) const {
    std::vector<double> result(rows_.size());
    exec_.for_blocks(rows_.size(), kBlock, [&](Index, Range r) {
      for (Index j = r.begin; j < r.end; ++j) {
        for (const Index c : slice(In<Index>(problem_.topology->star_corner),
                                   problem_.topology->stars().group(rows_.vertex_of(j)))) {
          result[j] += dot3(rows_.derivatives(j, c, cotangent_),
                            {values[c], values[next_corner(c)], values[previous_corner(c)]});
        }
      }
    });
    return result;
  }

  /// Rows that follow from others get multipliers of least norm; they must not contradict them.
  /// scale: of each row before the sparse part is eliminated.
  Result<Eigen::VectorXd> independent(const Eigen::MatrixXd& schur, const Eigen::VectorXd& scale,
                                      const Eigen::VectorXd& rhs) const {
    constexpr double kDependent = 1e-9, kContradiction = 1e-7;
    const Eigen::MatrixXd scaled = scale.asDiagonal() * schur * scale.asDiagonal();
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(kDependent);
    solver.compute(scaled);
    const Eigen::VectorXd y = scale.asDiagonal() * solver.solve(scale.asDiagonal() * rhs);
    const Eigen::VectorXd gap = schur * y - rhs;
    Error error{.code = exact_ ? ErrorCode::FactorizationFailed : ErrorCode::ConstraintsConflict,
                .what = "angles contradict one another"};
    for (Index k = 0; k < gap.size(); ++k) {
      if (!(std::abs(gap[k]) <= kContradiction)) error.ids.push_back((*problem_.long_rows)[k].relation);
    }
    error.count = static_cast<Offset>(error.ids.size());
    if (error.count > 0) return fail(error);
    return y;
  }

  const Exec& exec_;
  const AngleProblem& problem_;
  const AngleRows& rows_;
  Index num_corners_;
  In<double> angle_;
  std::vector<double> hessian_, cotangent_;  // [3 T]
  std::vector<Index> row_order_;
  bool exact_ = false;
  std::optional<GlobalPhase> global_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> indefinite_;
};

AngleSystem::AngleSystem(const Exec& exec, const AngleProblem& problem)
    : parts_(std::make_unique<Parts>(exec, problem)) {}
AngleSystem::~AngleSystem() = default;

Result<void> AngleSystem::factor(In<double> angle, In<double> multiplier, bool exact) {
  return parts_->factor_at(angle, multiplier, exact);
}

Result<void> AngleSystem::solve(Out<double> multiplier, Out<double> long_multiplier, Out<double> step) {
  return parts_->solve(multiplier, long_multiplier, step);
}

double along(const LongAngleRow& row, In<double> values) {
  double sum = 0;
  for (const LongAngleRow::Term& term : row.terms) sum += term.factor * values[term.corner];
  return sum;
}

}  // namespace planish
