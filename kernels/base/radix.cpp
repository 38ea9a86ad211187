#include "kernels/base/radix.hpp"

namespace planish {

void radix_histogram(Range r, int shift, In<KeyedIndex> item, RadixHistogram& histogram) {
  histogram.fill(0);
  for (Index i = r.begin; i < r.end; ++i) ++histogram[radix_digit(item[i].key, shift)];
}

void radix_places(Out<RadixHistogram> block_histogram) {
  Index place = 0;
  for (int digit = 0; digit < kRadixDigits; ++digit) {
    for (RadixHistogram& histogram : block_histogram) {
      const Index count = histogram[digit];
      histogram[digit] = place;
      place += count;
    }
  }
}

void radix_scatter(Range r, int shift, In<KeyedIndex> item, RadixHistogram& place, Out<KeyedIndex> sorted) {
  for (Index i = r.begin; i < r.end; ++i) sorted[place[radix_digit(item[i].key, shift)]++] = item[i];
}

}  // namespace planish
