#include "engine/prepare/geometry.hpp"

#include "kernels/intrinsic/cotangents.hpp"
#include "kernels/intrinsic/curvature.hpp"

namespace planish {

Geometry measure_geometry(const Exec& exec, const PreparedMesh& prepared) {
  return measure_geometry(exec, prepared.mesh.surface(), prepared.topology);
}

Geometry measure_geometry(const Exec& exec, const Surface& mesh, const Topology& topology) {
  const Index num_triangles = mesh.num_triangles();
  Geometry geometry;
  geometry.frame.resize(num_triangles);
  geometry.cotangent.resize(mesh.corner_vertex.size());
  geometry.mollified.resize(num_triangles);
  std::vector<double> angle(mesh.corner_vertex.size());
  geometry.area = exec.sum_blocks(num_triangles, kBlock, [&](Range r) {
    rest_frames(r, mesh.position, mesh.corner_vertex, geometry.frame);
    cotangents(r, geometry.frame, geometry.cotangent, geometry.mollified);
    corner_angles(r, geometry.frame, angle);
    double sum = 0;
    for (Index t = r.begin; t < r.end; ++t) sum += area(geometry.frame[t]);
    return sum;
  });
  geometry.angle_sum.resize(mesh.num_vertices());
  exec.for_blocks(mesh.num_vertices(), kBlock, [&](Index, Range r) {
    angle_sums(r, angle, topology.stars(), topology.star_corner, geometry.angle_sum);
  });
  return geometry;
}

std::vector<Index> vertex_components(const Topology& topology, Index num_vertices) {
  std::vector<Index> component(num_vertices);
  for (Index v = 0; v < num_vertices; ++v)
    component[v] = topology.triangle_component[topology.star_corner[topology.star_begin[v]] / 3];
  return component;
}

}  // namespace planish
