// CGAL's ARAP parameterizer as it comes, file to file. Prints {"seconds", "energy"}: of the ARAP energy per area.
//
// usage: cgal_arap_peer MESH OUT.ply
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include <chrono>
#include <cstdio>

#include "engine/verify/certificate.hpp"
#include "engine/workpiece.hpp"
#include "io/mesh_files.hpp"

namespace {

using namespace planish;
using Point2 = CGAL::Simple_cartesian<double>::Point_2;
using Point3 = CGAL::Simple_cartesian<double>::Point_3;
using CgalMesh = CGAL::Surface_mesh<Point3>;
namespace parameterization = CGAL::Surface_mesh_parameterization;

CgalMesh surface_of(const Mesh& mesh) {
  CgalMesh surface;
  for (const Vec3 p : mesh.position) surface.add_vertex(Point3(p.x, p.y, p.z));
  const auto vertex = [&](Index c) {
    return CgalMesh::Vertex_index(static_cast<CgalMesh::size_type>(mesh.corner_vertex[c]));
  };
  for (Index t = 0; t < mesh.num_triangles(); ++t)
    surface.add_face(vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2));
  return surface;
}

/// Empty where CGAL fails.
std::vector<Vec2> map_of(CgalMesh& surface) {
  CgalMesh::Halfedge_index border;
  for (const auto h : surface.halfedges()) {
    if (surface.is_border(h)) border = h;
  }
  const auto uv_map = surface.add_property_map<CgalMesh::Vertex_index, Point2>("v:uv").first;
  const auto status = parameterization::parameterize(
      surface, parameterization::ARAP_parameterizer_3<CgalMesh>(), border, uv_map);
  if (status != parameterization::OK) {
    std::fprintf(stderr, "CGAL: %s\n", parameterization::get_error_message(status));
    return {};
  }
  std::vector<Vec2> uv;
  for (const auto v : surface.vertices()) uv.push_back({uv_map[v].x(), uv_map[v].y()});
  return uv;
}

double energy_of(const Exec& exec, const Mesh& mesh, In<Vec2> uv) {
  std::vector<RestFrame> frame(mesh.num_triangles());
  rest_frames({0, mesh.num_triangles()}, mesh.position, mesh.corner_vertex, frame);
  return certify(exec, mesh.surface(), build_topology(exec, mesh.surface()), frame, uv).arap;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto begin = std::chrono::steady_clock::now();
  const Exec exec;
  auto mesh = read_mesh(exec, argv[1]);
  if (!mesh) return 3;
  CgalMesh surface = surface_of(*mesh);
  const std::vector<Vec2> uv = map_of(surface);
  if (uv.empty()) return 6;
  Mesh flat;
  flat.corner_vertex = mesh->corner_vertex;
  for (const Vec2 z : uv) flat.position.push_back({z.x, z.y, 0});
  std::vector<std::string> warnings;
  if (!write_mesh(exec, argv[2], {.mesh = &flat}, warnings)) return 7;
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("{\"seconds\": %.3f, \"energy\": %.9e}\n", taken, energy_of(exec, *mesh, uv));
  return 0;
}
