// The global phase: a sparse Cholesky factorization, analysed once, factored per matrix, solved many times.
#pragma once

#include <memory>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/solve/fill_reducing_order.hpp"
#include "engine/solve/supernode_tree.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

/// Entries that the factor of a matrix of this pattern has, elimination order given (rows beyond it come last). Analysis
/// only.   Fails: OutOfMemory.
Result<Offset> factor_nonzeros(const SymmetricMatrix& matrix, In<Index> order);

/// Cholesky factor of a symmetric positive definite matrix, with a solve for two interleaved right-hand sides; all parallel
/// over the elimination tree, with the same bits for any number of threads.
class GlobalPhase {
 public:
  /// Symbolic analysis alone, its memory without that of the factor's values: refactor() comes before anything else.
  /// Fails: OutOfMemory.
  static Result<GlobalPhase> analyse(const Exec& exec, const SymmetricMatrix& matrix, In<Index> order);
  /// Symbolic analysis and factorization with a given order; rows beyond it are eliminated last.
  /// Fails: FactorizationFailed naming the row of the bad pivot (as Error::ids); OutOfMemory.
  static Result<GlobalPhase> factor(const Exec& exec, const SymmetricMatrix& matrix, In<Index> order);
  /// Factors another matrix of the same pattern; the analysis is kept. After a failure only refactor may be
  /// called. Fails: as factor().
  Result<void> refactor(const Exec& exec, const SymmetricMatrix& matrix);

  /// Keeps the factor in 16 bits an entry alone (kernels/sparse/strip_panel.hpp): a quarter of the memory and of the traffic of
  /// solves, whose arithmetic then is in single precision. What they solve with is one symmetric positive definite matrix, near
  /// the given one in the energy of every function, smooth or not. For iterations that need a metric, not a solution. Until the
  /// next refactor.   Cost: some ten solves.
  void round(const Exec& exec);
  bool is_rounded() const;

  GlobalPhase(GlobalPhase&&) noexcept;
  GlobalPhase& operator=(GlobalPhase&&) noexcept;
  ~GlobalPhase();

  /// x = matrix^-1 rhs for both components.   rhs, x [n], may be the same array. Solves and their halves share memory that the
  /// first one takes: one at a time.   Cost: reads the factor twice.
  void solve(const Exec& exec, In<Vec2> rhs, Out<Vec2> x) const;

  /// The two halves of a solve, for systems that this one is a part of: half = L^-1 P rhs, x = P^T L^-T half.
  void forward(const Exec& exec, In<Vec2> rhs, Out<Vec2> half) const;
  void backward(const Exec& exec, In<Vec2> half, Out<Vec2> x) const;
  /// The first half for sparse right-hand sides; rows of rhs are those of the matrix, of the results those of half.
  /// Cost: reads the panels between the entries and the roots, per column.
  std::vector<SparseColumn> forward(const Exec& exec, const std::vector<SparseColumn>& rhs) const;

  /// Entries of the factor.
  Offset factor_nonzeros() const;

 private:
  struct Factor;
  explicit GlobalPhase(std::unique_ptr<Factor> factor);
  std::unique_ptr<Factor> factor_;
};

}  // namespace planish
