// Rows of a sparse matrix that are coupled with the same others, two at a time: one vertex of a graph for both.
#pragma once

#include <optional>
#include <vector>

#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

/// Rows j and j + 1 that are coupled, have the same neighbours otherwise and are eliminated one after the other are one row
/// here: the coordinates of a vertex. Others stand alone.
struct TwinRows {
  std::vector<Index> first;  ///< [G + 1] of the matrix's rows in each of these, one or two
  SymmetricMatrix pattern;   ///< of these; its values are empty
  std::vector<Index> order;  ///< [G] of elimination

  Index width(Index group) const { return first[group + 1] - first[group]; }
};

/// None where so few rows have a twin that it does not pay.
/// order [n]: of elimination, whole.   Cost: O(n), and O(nonzeros) where there are twins.
std::optional<TwinRows> find_twin_rows(const SymmetricMatrix& matrix, In<Index> order);

}  // namespace planish
