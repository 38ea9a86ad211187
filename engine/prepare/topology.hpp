// Adjacency of a triangle mesh, filled in parallel, the same for any number of threads.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/mesh.hpp"
#include "kernels/base/offsets.hpp"
#include "kernels/topology/corners.hpp"

namespace planish {

struct Topology {
  std::vector<Index> corner_twin;   ///< [3 T] twin of each half-edge, kNone on boundaries and broken edges
  std::vector<EdgeKind> edge_kind;  ///< [3 T]
  std::vector<Index> star_begin;    ///< [V + 1]
  std::vector<Index> star_corner;   ///< [3 T] corners around each vertex, counter-clockwise where single_fan
  std::vector<std::uint8_t> single_fan;   ///< [V] 1 where the star is one fan
  std::vector<Index> triangle_component;  ///< [T] edge-connected components, numbered by their first triangle
  Index num_components = 0;

  /// Boundary loops by decreasing length (ties: the loop of the smaller corner first); half-edges in order,
  /// surface on the left. Empty unless the mesh is a consistently oriented manifold.
  std::vector<Index> loop_begin;    ///< [L + 1]
  std::vector<Index> loop_corner;   ///< half-edges
  std::vector<double> loop_length;  ///< [L] in units of the positions

  bool manifold = false;  ///< every edge Interior or Boundary, every star one fan
  Index num_edges = 0;    ///< of the edges with one or two triangles when all are such

  Offsets stars() const { return {star_begin}; }
  Offsets loops() const { return {loop_begin}; }
  Index num_loops() const { return loop_begin.empty() ? 0 : static_cast<Index>(loop_begin.size()) - 1; }
  bool is_boundary(Index v) const { return corner_twin[star_corner[star_begin[v]]] == kNone; }
};

/// Pre: indices in range; every vertex is used.   Cost: O(T), parallel; some 60 bytes a triangle.
Topology build_topology(const Exec& exec, const Surface& surface);

}  // namespace planish
