// Elimination orders for sparse Cholesky factorizations.
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

/// Fill-reducing elimination order by nested dissection, parts of two sides at a time, small parts by minimum degree; order[k]
/// is the row eliminated k-th. Rows with far more entries than a mesh gives come last. The same for any number of threads.
/// Fails: OutOfMemory.   Cost: O(nonzeros log n).
Result<std::vector<Index>> fill_reducing_order(const Exec& exec, const SymmetricMatrix& matrix);

}  // namespace planish
