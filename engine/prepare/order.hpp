// The mesh as the engine works on it: centred, scaled, used vertices only, in a locality-keeping order.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

struct OrderedMesh {
  std::vector<Vec3> position;  ///< [V] (input - centre) / unit: inside a cube of edge 1 around the origin
  std::vector<Index> corner_vertex;    ///< [3 T]
  std::vector<Index> vertex_origin;    ///< [V] vertex of the input; ascending along a Hilbert curve
  std::vector<Index> triangle_origin;  ///< [T] triangle of the input; the corners keep their places in it
  Index num_input_vertices = 0;
  Vec3 centre;      ///< of the input's bounding box
  double unit = 1;  ///< largest edge of the box, mesh units, > 0

  Surface surface() const { return {position, corner_vertex}; }
  Index num_vertices() const { return static_cast<Index>(position.size()); }
  Index num_triangles() const { return static_cast<Index>(triangle_origin.size()); }
};

/// Positions that are not finite are carried along, and left out of the box.
/// Pre: indices in range.   Cost: O(T), parallel.
OrderedMesh order_mesh(const Exec& exec, const Surface& surface);

}  // namespace planish
