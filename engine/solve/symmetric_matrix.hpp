// Sparse symmetric matrix: its lower triangle by columns.
#pragma once

#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// Column j holds rows row[k] >= j, ascending, diagonal first, for k in [column_begin[j], column_begin[j +
/// 1]).
struct SymmetricMatrix {
  std::vector<Index> column_begin;  ///< [n + 1]
  std::vector<Index> row;
  std::vector<double> value;
  Index size() const { return static_cast<Index>(column_begin.size()) - 1; }
};

}  // namespace planish
