// An independent implementation of the same energy: CGAL's ARAP parameterizer.
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <doctest/doctest.h>

#include "engine/flatten.hpp"
#include "engine/verify/certificate.hpp"
#include "tests/support/cgal_map.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// CGAL's map, from its own start, close to rigid (lambda large) and run far beyond its default tolerance.
std::vector<Vec2> map_by_cgal(const Mesh& mesh) {
  using Arap = CGAL::Surface_mesh_parameterization::ARAP_parameterizer_3<cgal::SurfaceMesh>;
  auto uv = cgal::map_of(mesh, Arap({}, {}, 1e7, 2000, 1e-14));
  REQUIRE(uv);
  return std::move(*uv);
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
