// An independent implementation of least squares conformal maps: CGAL's, with the same two pins.
#include <CGAL/Surface_mesh_parameterization/LSCM_parameterizer_3.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "engine/flatten.hpp"
#include "engine/methods/conformal_map.hpp"
#include "tests/support/cgal_map.hpp"

using namespace planish;

namespace {

std::vector<Vec2> map_by_cgal(const Mesh& mesh, Index first, Index second) {
  namespace smp = CGAL::Surface_mesh_parameterization;
  using Pins = smp::Two_vertices_parameterizer_3<cgal::SurfaceMesh>;
  using Lscm = smp::LSCM_parameterizer_3<cgal::SurfaceMesh, Pins>;
  auto uv = cgal::map_of(mesh, Lscm(Pins(cgal::vertex(first), cgal::vertex(second))));
  REQUIRE(uv);
  return std::move(*uv);
}

/// The largest distance over the extent, once the second map's pins lie on the first one's.
double largest_difference(In<Vec2> a, std::vector<Vec2> b, Index first, Index second) {
  const Vec2 from = b[second] - b[first], to = a[second] - a[first];
  const Vec2 factor = (1 / dot(from, from)) * multiply(to, conjugate(from));
  const Vec2 start = b[first];
  double largest = 0, extent = 0;
  for (std::size_t v = 0; v < b.size(); ++v) {
    b[v] = a[first] + multiply(factor, b[v] - start);
    largest = std::max(largest, norm(a[v] - b[v]));
    extent = std::max(extent, norm(a[v] - a[first]));
  }
  return largest / extent;
}

/// An icosahedron without the faces at one corner, each face cut into n x n: doubly curved, and all triangles equal. CGAL's
/// equations are not divided by roots of areas, so that large triangles weigh more than in the energy of the paper; on equal
/// ones both have the same minimum.
Mesh equal_triangles(Index n) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  const Vec3 corner[] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                         {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const Index face[][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                           {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                           {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  Mesh mesh;
  std::map<std::array<std::int64_t, 3>, Index> number;
  const auto vertex = [&](Vec3 p) {
    const auto key = [](double x) { return static_cast<std::int64_t>(std::llround(1e9 * x)); };
    const auto [entry, added] = number.try_emplace({key(p.x), key(p.y), key(p.z)}, mesh.num_vertices());
    if (added) mesh.position.push_back(p);
    return entry->second;
  };
  for (const auto& f : face) {
    const Vec3 o = corner[f[0]], a = (1.0 / n) * (corner[f[1]] - o), b = (1.0 / n) * (corner[f[2]] - o);
    const auto at = [&](Index i, Index j) { return vertex(o + double(i) * a + double(j) * b); };
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; i + j < n; ++j) {
        for (const Index v : {at(i, j), at(i + 1, j), at(i, j + 1)}) mesh.corner_vertex.push_back(v);
        if (i + j + 1 == n) continue;
        for (const Index v : {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}) mesh.corner_vertex.push_back(v);
      }
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("lscm: CGAL's map with the same two pins is the same where triangles are equal") {
  for (const Index n : {3, 12, 30}) {
    const Mesh mesh = equal_triangles(n);
    const Index first = 0, second = mesh.num_vertices() - 1;
    ConstraintSet set;
    set.constraints.push_back(
        {.name = "pins", .type = "pin", .rule = PinConstraint{{first, second}, {{0.25, 0.5}, {1.5, -0.25}}}});
    const auto ours = flatten(mesh.surface(), {.set = &set}, {.method = Method::Lscm});
    REQUIRE(ours);
    CHECK(norm(ours->uv[first] - Vec2{0.25, 0.5}) < 1e-14);
    CHECK(norm(ours->uv[second] - Vec2{1.5, -0.25}) < 1e-14);
    CHECK(ours->certificate.arap > 0.01);
    CHECK(largest_difference(ours->uv, map_by_cgal(mesh, first, second), first, second) < 1e-6);
  }
}

TEST_CASE("lscm: without pins of the user's, CGAL's map with the far pair pinned is the same") {
  const Mesh mesh = equal_triangles(16);
  const Exec exec(1);
  auto piece = make_workpiece(exec, mesh.surface());
  REQUIRE(piece);
  piece->outer_loop = outer_loops(piece->topology());
  const auto pair = far_pair(*piece, 0);
  const Index first = piece->mesh().vertex_origin[pair[0]], second = piece->mesh().vertex_origin[pair[1]];
  const auto ours = flatten(mesh.surface(), {.method = Method::Lscm});
  REQUIRE(ours);
  CHECK(largest_difference(ours->uv, map_by_cgal(mesh, first, second), first, second) < 1e-6);
}
