// One pass of a stable least-significant-digit radix sort, split into blocks: histograms of all blocks, one
// scan over digits and blocks, then every block scatters into places of its own. Any split gives the same
// order.
#pragma once

#include <array>

#include "kernels/base/types.hpp"

namespace planish {

inline constexpr int kRadixBits = 11;
inline constexpr int kRadixDigits = 1 << kRadixBits;
using RadixHistogram = std::array<Index, kRadixDigits>;

/// A key and the index that travels with it.
struct KeyedIndex {
  std::uint64_t key = 0;
  Index index = 0;
};

inline int radix_digit(std::uint64_t key, int shift) {
  return static_cast<int>((key >> shift) & (kRadixDigits - 1));
}

/// Counts the digits of item[r]; histogram is overwritten.
void radix_histogram(Range r, int shift, In<KeyedIndex> item, RadixHistogram& histogram);

/// Turns the blocks' counts into the first place of each (digit, block), digits first, blocks in order.
void radix_places(Out<RadixHistogram> block_histogram);

/// Moves item[r] to its places; place (this block's row) is advanced.
void radix_scatter(Range r, int shift, In<KeyedIndex> item, RadixHistogram& place, Out<KeyedIndex> sorted);

}  // namespace planish
