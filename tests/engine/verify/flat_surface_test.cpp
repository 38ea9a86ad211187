#include "engine/verify/flat_surface.hpp"

#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

std::vector<Vec2> dropped(const Mesh& mesh) {
  std::vector<Vec2> uv;
  for (const Index v : mesh.corner_vertex) uv.push_back({mesh.position[v].x, mesh.position[v].y});
  return uv;
}

/// Moves the triangles whose middle has x > 0, which tears the map along the middle where it has an edge.
std::vector<Vec2> parted(const Mesh& mesh) {
  std::vector<Vec2> uv = dropped(mesh);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    double x = 0;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) x += mesh.position[mesh.corner_vertex[c]].x;
    for (Index c = 3 * t; x > 0 && c < 3 * t + 3; ++c) uv[c].x += 10;
  }
  return uv;
}

}  // namespace

TEST_CASE("flat surface: a map without seams is one piece with the vertices of the mesh") {
  const Mesh mesh = shapes::height_field(9, shapes::flat);
  const FlatSurface flat = open_where_torn(Exec(2), mesh.surface(), dropped(mesh));
  CHECK(flat.torn_edges == 0);
  CHECK(flat.position.size() == mesh.position.size());
  CHECK(flat.topology.num_components == 1);
}

TEST_CASE("flat surface: where the map is torn vertices have copies, each with its uv and origin") {
  const Mesh mesh = shapes::height_field(9, shapes::flat, 0);
  const FlatSurface flat = open_where_torn(Exec(2), mesh.surface(), parted(mesh));
  CHECK(flat.torn_edges == 8);
  CHECK(flat.position.size() == mesh.position.size() + 9);
  CHECK(flat.topology.num_components == 2);
  const std::vector<Vec2> corner_uv = parted(mesh);
  for (std::size_t c = 0; c < corner_uv.size(); ++c) {
    CHECK(flat.uv[flat.corner_vertex[c]] == corner_uv[c]);
    CHECK(flat.origin[flat.corner_vertex[c]] == mesh.corner_vertex[c]);
  }
}

TEST_CASE(
    "flat surface: copies of a vertex that lie on one another stay copies where the edges beside are torn") {
  // A square in two triangles whose common edge is torn at one end only.
  Mesh mesh;
  mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.corner_vertex = {0, 1, 2, 0, 2, 3};
  std::vector<Vec2> uv = dropped(mesh);
  uv[4].y += 1;
  const FlatSurface flat = open_where_torn(Exec(1), mesh.surface(), uv);
  CHECK(flat.torn_edges == 1);
  CHECK(flat.position.size() == 6);
}

TEST_CASE("flat surface: unreferenced vertices are left out, the origins say which are used") {
  Mesh mesh = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.position.insert(mesh.position.begin(), {9, 9, 9});
  for (Index& v : mesh.corner_vertex) ++v;
  const FlatSurface flat = open_where_torn(Exec(1), mesh.surface(), dropped(mesh));
  CHECK(flat.origin == std::vector<Index>{1, 2, 3});
}
