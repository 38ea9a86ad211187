// Twins: the other half-edge of each edge, found by looking through the smaller of the two stars.
#pragma once

#include "kernels/base/offsets.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// How a half-edge i->j meets the others between the same two vertices.
enum class EdgeKind : std::uint8_t {
  Interior,      ///< exactly one other, j->i
  Boundary,      ///< no other
  Inconsistent,  ///< exactly one other, and it also runs i->j
  NonManifold,   ///< more than one other
};

/// Twin and kind of every half-edge of corners r.
///   corner_vertex [3 T];  stars / star_corner: the corners at each vertex, any order
///   twin [3 T] out: for Interior and Inconsistent the other half-edge, else kNone;  kind [3 T] out
/// Half-edges with both ends on one vertex are NonManifold.
/// Cost: O(smaller star) a corner.
void find_twins(Range r, In<Index> corner_vertex, Offsets stars, In<Index> star_corner, Out<Index> twin,
                Out<EdgeKind> kind);

}  // namespace planish
