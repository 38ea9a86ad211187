#include "kernels/base/radix.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace planish;

TEST_CASE("radix: one pass over two blocks keeps equal digits in order, whichever block scatters first") {
  const std::vector<KeyedIndex> item = {{5, 0}, {3, 1}, {5, 2}, {3, 3}, {0, 4}, {5, 5}};
  std::vector<RadixHistogram> place(2);
  radix_histogram({0, 4}, 0, item, place[0]);
  radix_histogram({4, 6}, 0, item, place[1]);
  radix_places(place);
  std::vector<KeyedIndex> sorted(item.size());
  radix_scatter({4, 6}, 0, item, place[1], sorted);
  radix_scatter({0, 4}, 0, item, place[0], sorted);
  std::vector<Index> order;
  for (const KeyedIndex& k : sorted) order.push_back(k.index);
  CHECK(order == std::vector<Index>{4, 1, 3, 0, 2, 5});
}
