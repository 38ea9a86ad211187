// CGAL's ARAP parameterizer as it comes, file to file. Prints {"seconds", "energy"}: of the ARAP energy per area.
//
// usage: cgal_arap_peer MESH OUT.ply
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>

#include <chrono>
#include <cstdio>

#include "engine/verify/certificate.hpp"
#include "engine/workpiece.hpp"
#include "io/mesh_files.hpp"
#include "tests/support/cgal_map.hpp"

namespace {

using namespace planish;

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
  using Arap = CGAL::Surface_mesh_parameterization::ARAP_parameterizer_3<cgal::SurfaceMesh>;
  const auto uv = cgal::map_of(*mesh, Arap());
  if (!uv) {
    std::fprintf(stderr, "CGAL: %s\n", uv.error().what.c_str());
    return 6;
  }
  Mesh flat;
  flat.corner_vertex = mesh->corner_vertex;
  for (const Vec2 z : *uv) flat.position.push_back({z.x, z.y, 0});
  std::vector<std::string> warnings;
  if (!write_mesh(exec, argv[2], {.mesh = &flat}, warnings)) return 7;
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("{\"seconds\": %.3f, \"energy\": %.9e}\n", taken, energy_of(exec, *mesh, *uv));
  return 0;
}
