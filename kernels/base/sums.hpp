// Sums whose bits depend on the values alone, never on how the work was split.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// Sum by halving: error grows with log n, the tree depends on n only.
///   value [n] any unit.   Fails: never.   Cost: O(n), no allocation.
double pairwise_sum(In<double> value);

/// Sum of dot(a[i], b[i]) in several interleaved partial sums, so that additions need not wait for one another.
///   a, b [n].   Fails: never.   Cost: O(n), no allocation.
double dot(In<Vec2> a, In<Vec2> b);

}  // namespace planish
