// One linearisation of angle-based flattening, its angles and the triangles' multipliers eliminated.
#pragma once

#include <array>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/methods/angle_newton.hpp"
#include "engine/methods/angle_projection.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

/// With H the Lagrangian's second derivatives by the angles, P = H^-1 across what closes the triangles, J the rows' derivatives and
/// q the gradient: the system J P J^T of the rows' multipliers, its right-hand side, and the step of the angles.
class AngleBlocks {
 public:
  using Triple = std::array<double, 3>;

  AngleBlocks(const Exec& exec, const AngleProblem& problem);

  /// angle [3 T] must outlive what is asked for afterwards.   exact: H as it is; else made definite triangle by triangle.
  void linearise(In<double> angle, In<double> multiplier, bool exact);

  /// J P J^T.   Cost: O(T), parallel, as all below.
  SymmetricMatrix matrix() const;
  /// What rows miss, and J times plain_step().   rhs [rows] out, in the first coordinate
  void find_rhs(Out<Vec2> rhs) const;
  /// What the step would be without multipliers: minus P q and the triangles' own residuals, shared out.
  Triple plain_step(Index c) const;
  /// step [3 T] out.
  void find_step(In<double> multiplier, In<double> long_multiplier, Out<double> step) const;

  /// [3 T] P times the gradient of a long row.
  std::vector<double> projected(const LongAngleRow& row) const;
  /// [rows] J times a vector over corners.
  std::vector<double> in_rows(In<double> values) const;

  Index num_corners() const { return num_corners_; }
  Index num_rows() const { return rows_.size(); }
  In<double> angle() const { return angle_; }

 private:
  Index vertex(Index c) const { return problem_.corner_vertex[c]; }
  void regularise(Index t);
  double wheel_multiplier(In<double> multiplier, Index v) const;
  Projection projection(Index c) const {
    return {{hessian_[c], hessian_[next_corner(c)], hessian_[previous_corner(c)]}};
  }

  const Exec& exec_;
  const AngleProblem& problem_;
  const AngleRows& rows_;
  Index num_corners_;
  In<double> angle_;
  std::vector<double> hessian_, cotangent_;  // [3 T]
};

}  // namespace planish
