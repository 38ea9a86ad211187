// A walk over the surface that passes some vertices several times, as pieces that do not.
#pragma once

#include <vector>

#include "engine/model/embedding.hpp"

namespace planish {

/// A point of a walk; points inside edges come once in it, vertices may come again.
struct WalkPoint {
  SurfacePoint at;
  Vec3 position;
  Index vertex = kNone;  ///< where it is at a vertex
};

struct WalkPiece {
  std::vector<WalkPoint> point;
  bool closed = false;
};

/// Pieces with at least two points (closed: three) in which no vertex comes twice: loops are taken off where
/// the walk comes back to a vertex; a step that is taken back at once is left as an open piece (a spur).
/// Consecutive points of the walk differ. A piece keeps the order of the walk, and each of its points the
/// representation with which the walk left it in this piece.
/// Cost: O(n log n).
std::vector<WalkPiece> simple_pieces(WalkPiece walk);

}  // namespace planish
