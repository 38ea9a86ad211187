// A positive definite system with a few real unknowns beside the many complex ones of a global phase.
#pragma once

#include <memory>
#include <vector>

#include "engine/solve/global_phase.hpp"

namespace planish {

/// The system [K B; B^H D] [x; y] = [f; g] with K the global phase's real matrix, x and f complex, y and g real, and
/// "=" in its last rows for real parts: the stationary point of x^H K x / 2 + Re(x^H B y) + y^T D y / 2 - Re(f^H x) -
/// g^T y. Eliminated as the last columns of one Cholesky factor: a solve reads K's factor twice, as without a border.
class BorderedPhase {
 public:
  /// columns: of B, sparse, rows of K distinct;  corner: D, [m * m] symmetric.
  /// inner must outlive the result.
  /// Fails: FactorizationFailed where the Schur complement is not positive definite by more than rounding.
  /// Cost: a sparse forward solve a column; O(m^2) times the rows that columns have in common; O(m^3).
  static Result<BorderedPhase> factor(const Exec& exec, const GlobalPhase& inner,
                                      const std::vector<SparseColumn>& columns, In<double> corner);
  BorderedPhase(BorderedPhase&&) noexcept;
  BorderedPhase& operator=(BorderedPhase&&) noexcept;
  ~BorderedPhase();

  Index size() const;  ///< m
  /// rhs and x [n] may be the same array, so may rhs_border and y [m].
  void solve(const Exec& exec, In<Vec2> rhs, In<double> rhs_border, Out<Vec2> x, Out<double> y) const;
  /// The same with the real unknowns behind the complex ones, in x of further entries: rhs, x [n + m].
  void solve(const Exec& exec, In<Vec2> rhs, Out<Vec2> x) const;

 private:
  struct Parts;
  explicit BorderedPhase(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace planish
