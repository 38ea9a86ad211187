// Rest geometry of an ordered mesh, measured once.
#pragma once

#include <vector>

#include "engine/prepare/prepare.hpp"
#include "kernels/intrinsic/cotangents.hpp"

namespace planish {

/// In the units of the ordered mesh.
struct Geometry {
  std::vector<RestFrame> frame;         ///< [T]
  std::vector<double> cotangent;        ///< [3 T]
  std::vector<double> angle_sum;        ///< [V] radians
  std::vector<std::uint8_t> mollified;  ///< [T] 1 where weights were floored
  double area = 0;

  /// Cotangent weight of the edge of half-edge c.
  double edge_weight(const Topology& topology, Index c) const {
    return edge_cotangent(cotangent, c, topology.corner_twin[c]);
  }
};
Geometry measure_geometry(const Exec& exec, const PreparedMesh& prepared);
/// The same of other positions of the mesh.
Geometry measure_geometry(const Exec& exec, const Surface& surface, const Topology& topology);

/// Component of each vertex [V].
std::vector<Index> vertex_components(const Topology& topology, Index num_vertices);

}  // namespace planish
