#include "kernels/topology/stars.hpp"

#include <algorithm>

namespace planish {
namespace {

Index first_corner(In<Index> corners, In<Index> twin) {
  for (const Index c : corners) {
    if (twin[c] == kNone) return c;
  }
  return *std::min_element(corners.begin(), corners.end());
}

}  // namespace

void rotate_stars(Range r, In<Index> twin, Offsets stars, Out<Index> star_corner, Out<Index> scratch,
                  Out<std::uint8_t> single_fan) {
  for (Index v = r.begin; v < r.end; ++v) {
    const Range star = stars.group(v);
    single_fan[v] = 1;
    if (star.begin == star.end) continue;
    const Index first = first_corner(slice(In<Index>(star_corner), star), twin);
    Index k = star.begin, c = first;
    do {
      scratch[k++] = c;
      c = rotate_ccw(c, twin);
    } while (c != kNone && c != first && k < star.end);
    const bool one_fan = k == star.end && (c == kNone || c == first);
    single_fan[v] = one_fan ? 1 : 0;
    if (one_fan)
      std::copy(scratch.begin() + star.begin, scratch.begin() + star.end, star_corner.begin() + star.begin);
  }
}

}  // namespace planish
