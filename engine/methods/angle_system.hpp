// The linear system of a Newton step of angle-based flattening.
#pragma once

#include "engine/methods/angle_blocks.hpp"
#include "engine/methods/angle_factor.hpp"

namespace planish {

/// The step and the multipliers of [H J^T; J 0] [step; multipliers] = -[2 weight (angle - wanted); residuals]: triangles'
/// multipliers are eliminated one by one, then the angles, and the rows' multipliers are solved for.
class AngleSystem {
 public:
  AngleSystem(const Exec& exec, const AngleProblem& problem);

  /// Linearises at angles [3 T], which must outlive the solve, with the multipliers [rows] of the step before.
  /// exact: the Lagrangian's Hessian as it is; else made definite triangle by triangle.
  /// Fails: FactorizationFailed, OutOfMemory.
  Result<void> factor(In<double> angle, In<double> multiplier, bool exact);

  /// multiplier [rows], long_multiplier [long rows], step [3 T] out.   Pre: factor() succeeded.
  /// Fails: ConstraintsConflict (ids: relations) where long rows contradict one another; FactorizationFailed where that is
  /// found in an exact system, which may be singular otherwise.
  Result<void> solve(Out<double> multiplier, Out<double> long_multiplier, Out<double> step) const;

 private:
  const AngleProblem& problem_;
  AngleBlocks blocks_;
  AngleFactor factor_;
  bool exact_ = false;
};

}  // namespace planish
