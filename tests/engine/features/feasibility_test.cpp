#include "engine/features/feasibility.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// Triangles all of whose corners are on the chain.
Index prescribed_triangles(const RefinedMesh& mesh, In<Index> chain) {
  Index count = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    bool all = true;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      all &= std::find(chain.begin(), chain.end(), mesh.vertex(c)) != chain.end();
    }
    count += all ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("feasibility: the ears of a straightened boundary get a free corner") {
  const Mesh mesh = shapes::height_field(6, shapes::flat, 0);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  std::vector<Index> rim;
  for (const Index c : topology.loop_corner) rim.push_back(mesh.corner_vertex[c]);
  for (const bool straight : {true, false}) {
    RefinedMesh refined(mesh.surface(), topology);
    for (std::size_t k = 0; k < rim.size(); ++k) {
      refined.constrain(refined.edge_between(rim[k], rim[(k + 1) % rim.size()]));
    }
    const Index before = prescribed_triangles(refined, rim);
    REQUIRE(before > 0);
    const Index splits = free_prescribed_triangles(refined, {{rim, straight}});
    CHECK(splits == before);  // each ear of this mesh has one edge inside
    CHECK(prescribed_triangles(refined, rim) == 0);
    CHECK(free_prescribed_triangles(refined, {{rim, straight}}) == 0);
  }
}

TEST_CASE("feasibility: an edge between two places of a straight chain is split, of a curved one is not") {
  // A strip one triangle wide, bent back: its inner edges join vertices of the rim.
  const Mesh mesh = shapes::height_field(3, shapes::flat, 0);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  const std::vector<Index> row = {0, 1, 4};  // two edges around a corner; the edge 0-4 joins its ends
  RefinedMesh straight(mesh.surface(), topology), curved(mesh.surface(), topology);
  REQUIRE(straight.edge_between(0, 4) != kNone);
  for (RefinedMesh* refined : {&straight, &curved}) {
    refined->constrain(refined->edge_between(0, 1));
    refined->constrain(refined->edge_between(1, 4));
  }
  CHECK(free_prescribed_triangles(straight, {{row, true}}) == 1);
  CHECK(straight.edge_between(0, 4) == kNone);
  CHECK(free_prescribed_triangles(curved, {{row, false}}) == 1);  // its triangle 0 1 4 is prescribed too
}
