// An independent implementation of the same energy: CGAL's ARAP parameterizer.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>
#include <CGAL/boost/graph/helpers.h>
#include <doctest/doctest.h>

#include "engine/flatten.hpp"
#include "engine/verify/certificate.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

using Point2 = CGAL::Simple_cartesian<double>::Point_2;
using Point3 = CGAL::Simple_cartesian<double>::Point_3;
using CgalMesh = CGAL::Surface_mesh<Point3>;

/// CGAL's map, from its own start, close to rigid (lambda large) and run far beyond its default tolerance.
std::vector<Vec2> map_by_cgal(const Mesh& mesh) {
  namespace smp = CGAL::Surface_mesh_parameterization;
  CgalMesh surface;
  for (const Vec3 p : mesh.position) surface.add_vertex(Point3(p.x, p.y, p.z));
  const auto vertex = [&](Index c) {
    return CgalMesh::Vertex_index(static_cast<CgalMesh::size_type>(mesh.corner_vertex[c]));
  };
  for (Index t = 0; t < mesh.num_triangles(); ++t)
    surface.add_face(vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2));
  CgalMesh::Halfedge_index border;
  for (const auto h : surface.halfedges()) {
    if (surface.is_border(h)) border = h;
  }
  const auto uv_map = surface.add_property_map<CgalMesh::Vertex_index, Point2>("v:uv").first;
  using Arap = smp::ARAP_parameterizer_3<CgalMesh>;
  REQUIRE(smp::parameterize(surface, Arap({}, {}, 1e7, 2000, 1e-14), border, uv_map) == smp::OK);
  std::vector<Vec2> uv;
  for (const auto v : surface.vertices()) uv.push_back({uv_map[v].x(), uv_map[v].y()});
  return uv;
}

double energy_of(const Mesh& mesh, const std::vector<Vec2>& uv) {
  const Exec exec(1);
  std::vector<RestFrame> frame(mesh.num_triangles());
  rest_frames({0, mesh.num_triangles()}, mesh.position, mesh.corner_vertex, frame);
  return certify(exec, mesh.surface(), build_topology(exec, mesh.surface()), frame, uv).arap;
}

}  // namespace

TEST_CASE("flatten: CGAL's ARAP parameterizer ends at the same energy, and ours is not above it") {
  const Mesh mesh = shapes::wavy_disk(800);
  const double cgal = energy_of(mesh, map_by_cgal(mesh));
  const auto ours = flatten(mesh.surface());
  REQUIRE(ours);
  CHECK(ours->certificate.arap <= cgal * (1 + 1e-9));
  CHECK(ours->certificate.arap == doctest::Approx(cgal).epsilon(1e-4));
}
