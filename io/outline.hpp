// The edges that a drawing of a mesh shows: boundary chains, and every inner edge once.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"

namespace planish {

struct Outline {
  /// Vertices along the boundary, the mesh on their left; first and last are equal where the chain is closed.
  std::vector<std::vector<Index>> boundary;
  /// Corners whose half-edges are not on the boundary, one of each pair of twins (all, where edges are not
  /// manifold).
  std::vector<Index> inner;
  std::vector<Index> twin;  ///< [3 T] the other half-edge, or kNone
};

/// corner_vertex [3 T], each in [0, num_vertices).   Fails: never, on any mesh.   Cost: O(T), 40 bytes a
/// triangle.
Outline find_outline(const Exec& exec, In<Index> corner_vertex, Index num_vertices);

}  // namespace planish
