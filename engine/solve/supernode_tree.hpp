// Triangular solves over a supernodal Cholesky factor, parallel over disjoint subtrees of its elimination
// tree.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "kernels/sparse/strip_panel.hpp"

namespace planish {

/// The panels of a factor as strips: entries of supernode s at entry[begin[s]], three numbers a column.
struct StripFactor {
  In<Offset> begin;
  const std::int16_t* entry = nullptr;
  StripColumns<const float> column;
  const StripSolves* solves = nullptr;
};

/// Views of a supernodal factor L of P A P^T = L L^T, columns postordered. Supernode s holds the columns
/// [super[s], super[s + 1]), its row numbers are row[row_begin[s], row_begin[s + 1]) (its own columns first)
/// and its panel starts at value[value_begin[s]].
struct SupernodalFactor {
  In<Index> super, row_begin, row;
  In<Offset> value_begin;
  const double* value = nullptr;
  StripFactor strips;  ///< used instead where there are any
  const PanelSolves* solves = nullptr;
  In<Index> permutation;  ///< permutation[k] is the row of A at place k
  Index num_supernodes() const { return static_cast<Index>(super.size()) - 1; }
  Index columns(Index s) const { return super[s + 1] - super[s]; }
  Index rows(Index s) const { return row_begin[s + 1] - row_begin[s]; }
};

/// Entries of a sparse vector of complex numbers; rows ascending once it was solved with.
struct SparseColumn {
  std::vector<Index> row;
  std::vector<Vec2> value;
};

/// Memory that solves reuse, so that only the first allocates. One solve at a time.
template <class Point, class Number>
struct SolveMemory {
  std::vector<Point> y;         ///< [n] in the factor's order
  std::vector<Point> to_top;    ///< each task's own sum for the columns above the tasks
  std::vector<Number> scratch;  ///< of panels that are worked on at the same time
};

/// How the solve is split: subtrees of bounded work, each a task, and the supernodes above them, level by level. The split
/// depends on the factor alone, so the bits do not depend on the number of threads.
class SupernodeTree {
 public:
  SupernodeTree() = default;
  explicit SupernodeTree(const SupernodalFactor& factor);

  /// x = A^-1 rhs, two interleaved right-hand sides; rhs and x [n] may be the same array.
  void solve(const Exec& exec, const SupernodalFactor& factor, In<Vec2> rhs, Out<Vec2> x);
  /// Its halves: half <- L^-1 P rhs and x <- P^T L^-T half.
  void forward(const Exec& exec, const SupernodalFactor& factor, In<Vec2> rhs, Out<Vec2> half);
  void backward(const Exec& exec, const SupernodalFactor& factor, In<Vec2> half, Out<Vec2> x);

  /// L^-1 of sparse vectors; rows in the factor's order, distinct.
  /// Cost: reads the panels on the way from the entries to the roots, per vector.
  std::vector<SparseColumn> forward(const SupernodalFactor& factor, In<SparseColumn> rhs) const;

 private:
  template <class Panels>
  class Solve;
  template <class Body>
  void with_solve(const Exec& exec, const SupernodalFactor& factor, Body&& body);
  template <class Panels>
  std::vector<SparseColumn> forward_sparse(const SupernodalFactor& factor, In<SparseColumn> rhs) const;
  std::vector<Index> reach(const SupernodalFactor& factor, In<Index> row) const;

  std::vector<Range> subtree_;  ///< contiguous supernodes of each task
  std::vector<std::vector<Index>>
      top_level_;                  ///< supernodes above the tasks, children in lower levels than parents
  std::vector<Index> top_place_;   ///< [n] place of a column among the top columns, or kNone
  std::vector<Index> top_column_;  ///< columns of the top supernodes
  std::vector<Index> parent_;      ///< of each supernode, kNone at roots
  Index most_rows_ = 0;            ///< of any panel
  Index most_at_once_ = 0;         ///< tasks, or supernodes of a level
  SolveMemory<Vec2, double> wide_;
  SolveMemory<FloatVec2, float> narrow_;
};

}  // namespace planish
