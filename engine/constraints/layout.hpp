// Prescribed directions on the mesh: edges whose images are laid out, assembly by assembly.
#pragma once

#include "engine/constraints/body.hpp"

namespace planish {

/// Feature vertices in the plane, each assembly in a frame of its own.
struct Layout {
  std::vector<Index> assembly;               ///< [V] kNone where a vertex is on no body with edges
  std::vector<Vec2> point;                   ///< [V]
  std::vector<std::uint8_t> fixed_edge;      ///< [3 T] 1: the half-edge's image is prescribed (twins alike)
  std::vector<std::uint8_t> fixed_triangle;  ///< [T] 1: all of it is, in a region or between two fixed edges

  /// Direction of a fixed half-edge in its assembly's frame, radians.
  double direction(In<Index> corner_vertex, Index c) const {
    return argument(point[corner_vertex[next_corner(c)]] - point[corner_vertex[c]]);
  }
};

/// Rotation of the triangle of a fixed half-edge c when its assembly's frame is the uv plane, radians: of a triangle that
/// is all fixed the closest one to its laid-out image, else the one that takes the half-edge to its image's direction.
double laid_out_rotation(const Layout& layout, const RestSurface& rest, Index c);

/// The rotation that takes half-edge c to its image exactly.
double edge_rotation(const Layout& layout, const RestSurface& rest, Index c);

}  // namespace planish
