#include "engine/methods/filled_surface.hpp"

#include <doctest/doctest.h>

#include "engine/prepare/connection.hpp"
#include "tests/engine/methods/method_shapes.hpp"

using namespace planish;

namespace {

Result<FilledSurface> filled(const shapes::Measured& on) {
  std::vector<Index> origin(on.mesh.num_vertices());
  for (Index v = 0; v < on.mesh.num_vertices(); ++v) origin[v] = v;
  return fill_holes(Exec(2), on.mesh.surface(), on.topology, on.frame, outer_loops(on.topology), origin);
}

}  // namespace

TEST_CASE("fill holes: a disk stays what it is") {
  const shapes::Measured disk(shapes::wavy_disk(200));
  const auto surface = filled(disk);
  REQUIRE(surface);
  CHECK(surface->corner_vertex == disk.mesh.corner_vertex);
  CHECK(surface->num_triangles() == surface->own_triangles);
}

TEST_CASE("fill holes: a flat frame becomes a disk of the whole square's area, its own triangles first") {
  const shapes::Measured frame(shapes::frame(16, shapes::flat));
  REQUIRE(frame.topology.num_loops() == 2);
  const auto surface = filled(frame);
  REQUIRE(surface);
  CHECK(surface->topology.manifold);
  CHECK(surface->topology.num_loops() == 1);
  CHECK(surface->num_vertices - surface->topology.num_edges + surface->num_triangles() == 1);
  CHECK(std::equal(frame.mesh.corner_vertex.begin(), frame.mesh.corner_vertex.end(),
                   surface->corner_vertex.begin()));
  CHECK(surface->own_vertices == frame.mesh.num_vertices());
  double whole = 0, smallest = kInfinity;
  for (const RestFrame& f : surface->frame) {
    whole += area(f);
    smallest = std::min(smallest, area(f));
  }
  CHECK(whole == doctest::Approx(4));
  CHECK(smallest > 1e-4);
}

TEST_CASE("fill holes: holes of several components are closed, each in its own") {
  const Mesh one = shapes::frame(13, shapes::flat);
  const shapes::Measured both(shapes::joined(one, one));
  const auto surface = filled(both);
  REQUIRE(surface);
  CHECK(surface->topology.num_components == 2);
  CHECK(surface->topology.num_loops() == 2);
}
