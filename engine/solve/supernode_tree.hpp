// Triangular solves over a supernodal Cholesky factor, parallel over disjoint subtrees of its elimination
// tree.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "kernels/sparse/supernode.hpp"

namespace planish {

/// Views of a supernodal factor L of P A P^T = L L^T, columns postordered. Supernode s holds the columns
/// [super[s], super[s + 1]), its row numbers are row[row_begin[s], row_begin[s + 1]) (its own columns first)
/// and its panel starts at value[value_begin[s]].
struct SupernodalFactor {
  In<Index> super, row_begin, row;
  In<Offset> value_begin;
  const double* value = nullptr;
  const float* rounded = nullptr;  ///< the same values in single precision, used instead where given
  const PanelSolves* solves = nullptr;
  In<Index> permutation;  ///< permutation[k] is the row of A at place k
  Index num_supernodes() const { return static_cast<Index>(super.size()) - 1; }
};

/// Entries of a sparse vector of complex numbers; rows ascending once it was solved with.
struct SparseColumn {
  std::vector<Index> row;
  std::vector<Vec2> value;
};

/// How the solve is split: subtrees of bounded work, each a task, and the supernodes above them, done in
/// order. The split depends on the factor alone, so the bits do not depend on the number of threads.
class SupernodeTree {
 public:
  SupernodeTree() = default;
  explicit SupernodeTree(const SupernodalFactor& factor);

  /// x = A^-1 rhs, two interleaved right-hand sides; rhs and x [n] may be the same array.
  void solve(const Exec& exec, const SupernodalFactor& factor, In<Vec2> rhs, Out<Vec2> x) const;

  /// y <- L^-1 y and y <- L^-T y, in the factor's order.
  void forward(const Exec& exec, const SupernodalFactor& factor, Out<Vec2> y) const;
  void backward(const Exec& exec, const SupernodalFactor& factor, Out<Vec2> y) const;

  /// L^-1 of a sparse vector, rows in the factor's order and distinct.
  ///   workspace [n]: zeros, and zeros again afterwards
  /// Cost: reads the panels on the way from the entries to the roots.
  SparseColumn forward(const SupernodalFactor& factor, const SparseColumn& rhs, Out<Vec2> workspace) const;

 private:
  std::vector<Index> reach(const SupernodalFactor& factor, In<Index> row) const;

  std::vector<Range> subtree_;     ///< contiguous supernodes of each task
  std::vector<Index> top_;         ///< supernodes above the tasks, ascending
  std::vector<Index> top_place_;   ///< [n] place of a column among the top columns, or kNone
  std::vector<Index> top_column_;  ///< columns of the top supernodes
  std::vector<Index> parent_;      ///< of each supernode, kNone at roots
  Index most_rows_ = 0;            ///< of any panel: length of a task's scratch
};

}  // namespace planish
