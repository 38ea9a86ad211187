// Stars in rotation order: the corners around a vertex, counter-clockwise seen with the front up.
#pragma once

#include "kernels/base/offsets.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// The corner after c around its vertex, counter-clockwise, or kNone across a boundary.
inline Index rotate_ccw(Index c, In<Index> twin) { return twin[previous_corner(c)]; }
/// The corner before c around its vertex, or kNone across a boundary.
inline Index rotate_cw(Index c, In<Index> twin) { return twin[c] == kNone ? kNone : next_corner(twin[c]); }

/// Puts the corners of each star of vertices r into rotation order, in place: from the corner whose half-edge
/// is on the boundary, or from the smallest corner where there is none.
///   twin [3 T] of consistently oriented edges (kNone elsewhere);  star_corner [3 T] in and out
///   single_fan [V] out: 0 where the corners do not form one fan; that star is left as it was
///   scratch: as large as star_corner, used at the same places
void rotate_stars(Range r, In<Index> twin, Offsets stars, Out<Index> star_corner, Out<Index> scratch,
                  Out<std::uint8_t> single_fan);

}  // namespace planish
