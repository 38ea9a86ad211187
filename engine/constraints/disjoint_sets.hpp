// Disjoint sets of indices (union-find).
#pragma once

#include <numeric>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// The smallest element of a set.
  Index root(Index x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }

  /// False where both were in one set already.
  bool unite(Index a, Index b) {
    a = root(a), b = root(b);
    if (a == b) return false;
    parent_[a < b ? b : a] = a < b ? a : b;
    return true;
  }

  /// Consecutive numbers of the sets, in the order of their smallest elements.
  std::vector<Index> labels() {
    std::vector<Index> label(parent_.size());
    count_ = 0;
    for (Index x = 0; x < static_cast<Index>(parent_.size()); ++x)
      label[x] = root(x) == x ? count_++ : label[root(x)];
    return label;
  }
  /// After labels().
  Index count() const { return count_; }

 private:
  std::vector<Index> parent_;
  Index count_ = 0;
};

}  // namespace planish
