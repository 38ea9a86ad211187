// What a sparse Cholesky factorization needs to know before it sees a number.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/solve/subtrees.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

/// Supernodes of the factor L of P A P^T = L L^T, postordered: a subtree is a contiguous range. Supernode s holds the columns
/// [super[s], super[s + 1]), its rows are row[row_begin[s], row_begin[s + 1]) (its own columns first, ascending) and its
/// panel, columns of equal length one behind the other, starts at value_begin[s].
struct CholeskyAnalysis {
  std::vector<Index> permutation;  ///< [n] permutation[k] is the row of A at place k
  std::vector<Index> super;        ///< [S + 1]
  std::vector<Index> row_begin;    ///< [S + 1]
  std::vector<Index> row;
  std::vector<Offset> value_begin;        ///< [S + 1]
  std::vector<Index> parent;              ///< [S] kNone at roots
  std::vector<Index> child_begin, child;  ///< of each supernode, ascending
  /// Place of each row below among the rows of the parent: those of s begin at row_begin[s] - super[s].
  std::vector<Index> relative;
  /// Entries of A in each panel: the nonzero they come from, and their place in it.
  std::vector<Index> entry_begin, entry_source, entry_place;
  Subtrees tasks;  ///< by the work of the factorization

  Index size() const { return static_cast<Index>(permutation.size()); }
  Index num_supernodes() const { return static_cast<Index>(parent.size()); }
  Index columns(Index s) const { return super[s + 1] - super[s]; }
  Index rows(Index s) const { return row_begin[s + 1] - row_begin[s]; }
  Index below(Index s) const { return rows(s) - columns(s); }
  In<Index> children(Index s) const {
    return In<Index>(child).subspan(child_begin[s], child_begin[s + 1] - child_begin[s]);
  }
  In<Index> relative_rows(Index s) const {
    return In<Index>(relative).subspan(row_begin[s] - super[s], below(s));
  }
  Offset factor_nonzeros() const { return value_begin.back(); }
  double flops()
      const;  ///< multiplications and additions of the factorization, zeros of relaxed supernodes included
};

/// Analysis for an elimination order; rows beyond it come last.
/// Fails: OutOfMemory.   Cost: near O(nonzeros of A + rows of the supernodes).
Result<CholeskyAnalysis> analyse_cholesky(const Exec& exec, const SymmetricMatrix& matrix, In<Index> order);

/// Entries of the factor alone.   Fails: OutOfMemory.
Result<Offset> count_factor(const SymmetricMatrix& matrix, In<Index> order);

}  // namespace planish
