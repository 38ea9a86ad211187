// Dense work of a Cholesky factorization on panels stored column by column, for each instruction set.
#pragma once

#include "kernels/sparse/simd.hpp"

namespace planish {

/// Matrix stored column by column: entry (i, j) is value[i + j * stride].
struct ColumnMajor {
  double* value = nullptr;
  Offset stride = 0;
  double* at(Index i, Index j) const { return value + i + j * stride; }
};

/// Every entry is a chain of multiplications and subtractions in ascending order of the columns multiplied, whatever the
/// shapes and the splits: the same bits for any number of threads, and the same for AVX2 and AVX-512. The baseline rounds
/// products, so its last bits differ.
struct DenseKernels {
  /// Factors columns [first, last) of a panel down to row `rows`: the square at (first, first) becomes its lower Cholesky
  /// factor L, the rows below become theirs times L^-T. What lies above the diagonal is not kept.
  /// Returns the first column whose pivot is not positive, or kNone.
  Index (*factor_columns)(ColumnMajor panel, Index first, Index last, Index rows);
  /// The rows r of those columns alone, r.begin >= last, where the square is factored.
  void (*solve_rows)(ColumnMajor panel, Index first, Index last, Range r);
  /// c -= a b^T for a [m x k], b [n x k], c [m x n]. With `fresh` c is taken as zero. With `lower` only entries (i, j) with
  /// i >= j are needed: others may be written or left.
  void (*subtract_products)(ColumnMajor c, ColumnMajor a, ColumnMajor b, Index m, Index n, Index k,
                            bool fresh, bool lower);
};

/// Pre: the processor has them.
const DenseKernels& dense_kernels(InstructionSet set);

}  // namespace planish
