// What tests of methods on angles measure by themselves.
#pragma once

#include "engine/prepare/prepare.hpp"
#include "engine/prepare/topology.hpp"
#include "engine/solve/fill_reducing_order.hpp"
#include "engine/solve/laplacian.hpp"
#include "kernels/intrinsic/lengths.hpp"
#include "tests/support/shapes.hpp"

namespace planish::shapes {

/// A mesh with what the solvers on angles take.
struct Measured {
  Mesh mesh;
  Topology topology;
  std::vector<RestFrame> frame;
  std::vector<double> angle;  // [3 T]
  std::vector<Index> order;   // of the vertices

  explicit Measured(Mesh given) : mesh(std::move(given)), topology(build_topology(Exec(1), mesh.surface())) {
    frame.resize(mesh.num_triangles());
    angle.resize(mesh.corner_vertex.size());
    rest_frames({0, mesh.num_triangles()}, mesh.position, mesh.corner_vertex, frame);
    corner_angles({0, mesh.num_triangles()}, frame, angle);
    const std::vector<std::uint8_t> none(mesh.num_vertices(), 0);
    order = *fill_reducing_order(
        Exec(1), vertex_laplacian(Exec(1), mesh.corner_vertex, topology, none, [](Index) { return 1.0; }));
  }

  std::vector<double> angle_sums() const {
    std::vector<double> sum(mesh.num_vertices(), 0);
    for (std::size_t c = 0; c < angle.size(); ++c) sum[mesh.corner_vertex[c]] += angle[c];
    return sum;
  }
};

/// Corner angles of a map, by vectors.
inline std::vector<double> map_angles(const std::vector<Index>& corner_vertex, const std::vector<Vec2>& uv) {
  std::vector<double> angle(corner_vertex.size());
  for (Index c = 0; c < static_cast<Index>(angle.size()); ++c) {
    const Vec2 z = uv[corner_vertex[c]];
    const Vec2 a = uv[corner_vertex[next_corner(c)]] - z, b = uv[corner_vertex[previous_corner(c)]] - z;
    angle[c] = std::atan2(cross(a, b), dot(a, b));
  }
  return angle;
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace planish::shapes
