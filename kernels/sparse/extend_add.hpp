// Adding what one supernode leaves to the front of its parent.
#pragma once

#include "kernels/sparse/dense.hpp"

namespace planish {

/// target(place[i] - first, place[j] - first) += update(i, j) for i >= j and columns j in r.
///   place [m] ascending: row and column of the target for those of update [m x m];  place[j] >= first for columns in r
/// Cost: reads the lower triangle of those columns once.
void extend_add(ColumnMajor target, Index first, In<Index> place, ColumnMajor update, Range r);

}  // namespace planish
