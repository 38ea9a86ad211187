// A tree of supernodes split for parallel work: subtrees of bounded work, and what stands above them.
#pragma once

#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// The split depends on the tree and the work alone, so results do not depend on the number of threads.
struct Subtrees {
  std::vector<Range>
      subtree;  ///< contiguous supernodes of each task: one subtree, or small ones beside one another
  std::vector<Index> top;  ///< supernodes above the tasks, ascending: children before parents
};

/// parent [S] postordered, kNone at roots;  work [S] of each supernode alone.   Tasks hold at most `share` of the work, or
/// `least` where that is more.
Subtrees split_into_subtrees(In<Index> parent, In<double> work, double share, double least);

}  // namespace planish
