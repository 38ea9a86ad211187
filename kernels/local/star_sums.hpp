// Sums of corner forces over stars.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// Vertices with equally many corners, one behind the other: vertex[begin, end), the corners of the first at slot_begin.
struct StarRun {
  Index degree = 0, begin = 0, end = 0, slot_begin = 0;
};

/// Sum of the corner forces at each vertex of r.   force [3 T];  vertex_force [V] out.
void gather_forces(Range r, In<Index> star_begin, In<Index> star_corner, In<Vec2> force,
                   Out<Vec2> vertex_force);

/// The same at the vertices of runs, in the same order of addition. One degree after the other, no branch goes another way
/// than the last one did.
///   slot: places of the corners in force
void gather_runs(In<StarRun> runs, In<Index> vertex, In<std::uint16_t> slot, In<Vec2> force,
                 Out<Vec2> vertex_force);

}  // namespace planish
