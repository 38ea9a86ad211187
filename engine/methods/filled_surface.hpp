// A surface whose holes are closed, for methods that flatten disks.
#pragma once

#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// The surface's own vertices and triangles keep their numbers; those that fill holes come after them.
struct FilledSurface {
  std::vector<Index> corner_vertex;  ///< [3 T]
  Index num_vertices = 0;
  Index own_vertices = 0, own_triangles = 0;
  Topology topology;             ///< one loop a component
  std::vector<RestFrame> frame;  ///< [T] units of the surface
  Index num_triangles() const { return static_cast<Index>(frame.size()); }
};

/// Every loop but the outer ones is closed by triangles about as fine as its edges, near to a surface of least area.
///   outer_loop: per component;  frame [T] of the surface
/// Fails: NotBuilt (holes, and planish is without CGAL's GPL packages); NoConvergence naming the vertices of the holes
///        that no triangles close.   Cost: O(n log n) to O(n^3) for a hole of n edges.
/// Ref: Liepa 2003.
Result<FilledSurface> fill_holes(const Exec& exec, const Surface& surface, const Topology& topology,
                                 In<RestFrame> frame, In<Index> outer_loop, In<Index> vertex_origin);

}  // namespace planish
