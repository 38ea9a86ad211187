#include "engine/exec/parallel.hpp"

#include <bit>

namespace planish {

void sort_by_key(const Exec& exec, std::vector<KeyedIndex>& items, int key_bits) {
  constexpr Index kSortBlock = 1 << 16;  // a histogram row of 8 kB is small beside it
  const auto n = static_cast<Index>(items.size());
  std::vector<KeyedIndex> sorted(items.size());
  std::vector<RadixHistogram> place(Exec::num_blocks(n, kSortBlock));
  for (int shift = 0; shift < key_bits; shift += kRadixBits) {
    exec.for_blocks(n, kSortBlock, [&](Index k, Range r) { radix_histogram(r, shift, items, place[k]); });
    radix_places(place);
    exec.for_blocks(n, kSortBlock,
                    [&](Index k, Range r) { radix_scatter(r, shift, items, place[k], sorted); });
    items.swap(sorted);
  }
}

int bits_for(std::uint64_t n) { return n <= 1 ? 1 : static_cast<int>(std::bit_width(n - 1)); }

std::vector<Index> exclusive_scan(In<Index> counts) {
  std::vector<Index> begin(counts.size() + 1, 0);
  for (std::size_t i = 0; i < counts.size(); ++i) begin[i + 1] = begin[i] + counts[i];
  return begin;
}

}  // namespace planish
