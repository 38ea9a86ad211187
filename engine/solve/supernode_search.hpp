// The supernodes of a sparse Cholesky factor, from the pattern of the matrix in the order of elimination.
#pragma once

#include <vector>

#include "kernels/base/offsets.hpp"

namespace planish {

/// Lists of rows, one behind the other.
struct Lists {
  std::vector<Index> begin, row;
  Offsets offsets() const { return {begin}; }
};

/// Place of each in an order.
inline std::vector<Index> inverse(In<Index> order) {
  std::vector<Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<Index>(k);
  return place;
}

/// Postordered supernodes over the elimination order.
struct Supernodes {
  std::vector<Index> place;  ///< [n] of the columns: where the order's k-th comes to stand
  std::vector<Index> columns, rows, parent;
};

/// earlier: the neighbours of each row that are eliminated before it, by places in the order, where row k stands for width[k] rows
/// that are eliminated one after the other with the same neighbours.   Cost: near O(nonzeros).
Supernodes find_supernodes(const Lists& earlier, In<Index> width);

}  // namespace planish
