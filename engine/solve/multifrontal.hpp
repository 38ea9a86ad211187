// The numbers of a sparse Cholesky factor, front by front up the tree of supernodes.
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/solve/cholesky_analysis.hpp"
#include "kernels/sparse/dense.hpp"

namespace planish {

/// Fills the panels of the factor. Each supernode gathers its entries of A and what its children leave, factors its panel,
/// and leaves its own products for its parent. Subtrees are tasks of their own; above them supernodes of one height run at a
/// time and share out their dense work. The order of all sums is that of the tree: the same bits for any number of threads.
///   value: of the matrix analysed, in its order;   panels [analysis.factor_nonzeros()] out
/// Returns the place of the first pivot that is not positive, in the order of elimination, or kNone.
/// Throws std::bad_alloc where the products that wait for their parents find no memory.
/// Ref: Duff and Reid 1983; Liu 1992 (two stacks by the parity of depth instead of one with moves).
Index factor_fronts(const Exec& exec, const CholeskyAnalysis& analysis, const DenseKernels& kernels,
                    In<double> value, double* panels);

}  // namespace planish
