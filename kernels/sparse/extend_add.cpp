#include "kernels/sparse/extend_add.hpp"

#include "kernels/base/lanes.hpp"

namespace planish {
namespace {

/// First of the rows that lie one behind the other to the end.
Index contiguous_from(In<Index> place) {
  auto i = static_cast<Index>(place.size()) - 1;
  while (i > 0 && place[i - 1] == place[i] - 1) --i;
  return i;
}

}  // namespace

PLANISH_CLONES void extend_add(ColumnMajor target, Index first, In<Index> place, ColumnMajor update,
                               Range r) {
  const auto m = static_cast<Index>(place.size());
  const Index straight = contiguous_from(place);
  for (Index j = r.begin; j < r.end; ++j) {
    double* __restrict to = target.at(0, place[j] - first);
    const double* __restrict from = update.at(0, j);
    Index i = j;
    for (; i < straight; ++i) to[place[i] - first] += from[i];
    const Index shift = place[m - 1] - first - (m - 1);
    for (; i < m; ++i) to[i + shift] += from[i];
  }
}

}  // namespace planish
