// Maps by CGAL's parameterizers: an implementation of others, for tests and benchmarks.
#pragma once

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"

namespace planish::cgal {

using Point2 = CGAL::Simple_cartesian<double>::Point_2;
using Point3 = CGAL::Simple_cartesian<double>::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point3>;

inline SurfaceMesh::Vertex_index vertex(Index v) {
  return SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(v));
}

inline SurfaceMesh surface_of(const Mesh& mesh) {
  SurfaceMesh surface;
  for (const Vec3 p : mesh.position) surface.add_vertex(Point3(p.x, p.y, p.z));
  for (std::size_t c = 0; c < mesh.corner_vertex.size(); c += 3)
    surface.add_face(vertex(mesh.corner_vertex[c]), vertex(mesh.corner_vertex[c + 1]),
                     vertex(mesh.corner_vertex[c + 2]));
  return surface;
}

/// [V]   Fails: NoConvergence with CGAL's words.   Pre: a disk.
template <class Parameterizer>
Result<std::vector<Vec2>> map_of(const Mesh& mesh, const Parameterizer& parameterizer) {
  namespace smp = CGAL::Surface_mesh_parameterization;
  SurfaceMesh surface = surface_of(mesh);
  SurfaceMesh::Halfedge_index border;
  for (const auto h : surface.halfedges()) {
    if (surface.is_border(h)) border = h;
  }
  const auto uv_map = surface.add_property_map<SurfaceMesh::Vertex_index, Point2>("v:uv").first;
  const auto status = smp::parameterize(surface, parameterizer, border, uv_map);
  if (status != smp::OK) return fail(ErrorCode::NoConvergence, smp::get_error_message(status));
  std::vector<Vec2> uv;
  for (const auto v : surface.vertices()) uv.push_back({uv_map[v].x(), uv_map[v].y()});
  return uv;
}

}  // namespace planish::cgal
