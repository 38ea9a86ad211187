#include "engine/solve/subtrees.hpp"

#include <algorithm>
#include <numeric>

namespace planish {

Subtrees split_into_subtrees(In<Index> parent, In<double> work, double share, double least) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<double> of_subtree(work.begin(), work.end());
  std::vector<Index> first(n);  // first supernode of the subtree: postordered, so the subtree is [first, s]
  std::iota(first.begin(), first.end(), 0);
  double total = 0;
  for (Index s = 0; s < n; ++s) {
    total += work[s];
    if (parent[s] == kNone) continue;
    of_subtree[parent[s]] += of_subtree[s];
    first[parent[s]] = std::min(first[parent[s]], first[s]);
  }
  const double most = std::max(share * total, least);
  Subtrees split;
  for (Index s = 0; s < n; ++s) {
    if (of_subtree[s] > most) {
      split.top.push_back(s);
    } else if (parent[s] == kNone || of_subtree[parent[s]] > most) {
      // Small neighbours share a task, so that a forest of many trees does not become many tasks.
      const bool joins = !split.subtree.empty() && split.subtree.back().end == first[s] &&
                         of_subtree[s] + of_subtree[split.subtree.back().end - 1] <= most;
      if (joins) {
        of_subtree[s] += of_subtree[split.subtree.back().end - 1];
        split.subtree.back().end = s + 1;
      } else {
        split.subtree.push_back({first[s], s + 1});
      }
    }
  }
  return split;
}

}  // namespace planish
