// Prescribed directions on the mesh: edges whose images are laid out, assembly by assembly.
#pragma once

#include "engine/constraints/body.hpp"

namespace planish {

/// Feature vertices in the plane, each assembly in a frame of its own.
struct Layout {
  std::vector<Index> assembly;               ///< [V] kNone where a vertex is on no body with edges
  std::vector<Vec2> point;                   ///< [V]
  std::vector<std::uint8_t> fixed_edge;      ///< [3 T] 1: the half-edge's image is prescribed (twins alike)
  std::vector<std::uint8_t> fixed_triangle;  ///< [T] 1: all of it is, as part of a region
  Index num_assemblies = 0;

  bool empty() const { return fixed_edge.empty(); }
  /// Direction of a fixed half-edge in its assembly's frame, radians.
  double direction(In<Index> corner_vertex, Index c) const {
    return argument(point[corner_vertex[next_corner(c)]] - point[corner_vertex[c]]);
  }
};

/// Half of an edge's turn from its triangle: the rotation that the triangle has when its assembly's frame is the uv plane.
/// Of a triangle of a region the closest rotation of its laid-out image, else the one that takes its half-edge c exactly.
double laid_out_rotation(const Layout& layout, const RestSurface& rest, Index c);

}  // namespace planish
