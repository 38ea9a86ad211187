#include "engine/prepare/cut.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// Interior half-edges from a to b.
std::vector<Index> half_edges(const Mesh& mesh, const std::vector<std::pair<Index, Index>>& edges) {
  std::vector<Index> found;
  for (const auto& [a, b] : edges) {
    for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
      if (mesh.corner_vertex[c] == a && mesh.corner_vertex[next_corner(c)] == b) found.push_back(c);
    }
  }
  REQUIRE(found.size() == edges.size());
  return found;
}

std::vector<Index> random_half_edges(Index num_corners, double share, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Index> corners;
  for (Index c = 0; c < num_corners; ++c) {
    if (random.uniform() < share) corners.push_back(c);
  }
  return corners;
}

/// corner_vertex as promised, from unions of corners across edges that stay: no rotation order is used.
std::vector<Index> expected_vertices(const Mesh& mesh, const Topology& topology, In<Index> cut_corner) {
  const auto& twin = topology.corner_twin;
  std::vector<char> cut(twin.size(), 0);
  for (Index c : cut_corner) {
    if (twin[c] != kNone) cut[c] = cut[twin[c]] = 1;
  }
  std::vector<Index> fan(twin.size());  // smallest corner of the fan, by repeated sweeps
  std::iota(fan.begin(), fan.end(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (Index c = 0; c < static_cast<Index>(fan.size()); ++c) {
      if (twin[c] == kNone || cut[c]) continue;
      for (const auto& [a, b] : {std::pair(c, next_corner(twin[c])), std::pair(next_corner(c), twin[c])}) {
        if (fan[a] == fan[b]) continue;
        fan[a] = fan[b] = std::min(fan[a], fan[b]);
        changed = true;
      }
    }
  }
  std::vector<std::pair<Index, Index>> fans;  // vertex, smallest corner
  for (Index c = 0; c < static_cast<Index>(fan.size()); ++c) {
    if (fan[c] == c) fans.emplace_back(mesh.corner_vertex[c], c);
  }
  std::sort(fans.begin(), fans.end());
  std::vector<Index> number(fan.size(), kNone), vertices;
  Index next = mesh.num_vertices();
  for (std::size_t k = 0; k < fans.size(); ++k) {
    const bool first = k == 0 || fans[k - 1].first != fans[k].first;
    number[fans[k].second] = first ? fans[k].first : next++;
  }
  for (Index c : fan) vertices.push_back(number[c]);
  return vertices;
}

Index euler(const CutSurface& opened, const Topology& topology) {
  return opened.surface().num_vertices() - topology.num_edges + opened.surface().num_triangles();
}

}  // namespace

TEST_CASE("open_along: random sets of edges give each fan a vertex, numbered as promised") {
  for (const Mesh& mesh :
       {shapes::wavy_disk(800), shapes::frame(15, shapes::flat), shapes::torus(12), shapes::cube(1)}) {
    const Exec exec(2);
    const Topology topology = build_topology(exec, mesh.surface());
    for (const double share : {0.0, 0.02, 0.2, 0.5, 1.0}) {
      const auto cut = random_half_edges(static_cast<Index>(mesh.corner_vertex.size()), share, 7);
      const CutSurface opened = open_along(exec, mesh.surface(), topology, cut);
      CHECK(opened.corner_vertex == expected_vertices(mesh, topology, cut));
      REQUIRE(opened.position.size() == opened.vertex_origin.size());
      for (Index v = 0; v < opened.surface().num_vertices(); ++v) {
        CHECK((v >= mesh.num_vertices() || opened.vertex_origin[v] == v));
        CHECK(opened.position[v] == mesh.position[opened.vertex_origin[v]]);  // bit for bit
      }
      for (std::size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
        CHECK(opened.vertex_origin[opened.corner_vertex[c]] == mesh.corner_vertex[c]);
      }
      CHECK(build_topology(exec, opened.surface()).manifold);
    }
  }
}

TEST_CASE(
    "open_along: edges that were not named stay joined, the parted ones are counted with their length") {
  const Mesh mesh = shapes::wavy_disk(1500);
  const Exec exec(2);
  const Topology before = build_topology(exec, mesh.surface());
  const auto cut = random_half_edges(static_cast<Index>(mesh.corner_vertex.size()), 0.1, 3);
  const CutSurface opened = open_along(exec, mesh.surface(), before, cut);
  const Topology after = build_topology(exec, opened.surface());
  std::vector<char> named(mesh.corner_vertex.size(), 0);
  for (Index c : cut) {
    named[c] = 1;
    if (before.corner_twin[c] != kNone) named[before.corner_twin[c]] = 1;
  }
  Index parted = 0;
  double length = 0;
  for (Index c = 0; c < static_cast<Index>(named.size()); ++c) {
    if (!named[c]) CHECK(after.corner_twin[c] == before.corner_twin[c]);
    if (before.corner_twin[c] < c || after.corner_twin[c] != kNone) continue;
    ++parted;
    length += norm(mesh.position[mesh.corner_vertex[next_corner(c)]] - mesh.position[mesh.corner_vertex[c]]);
  }
  CHECK(parted > 100);
  CHECK(opened.num_cut_edges == parted);
  CHECK(opened.cut_length == doctest::Approx(length).epsilon(1e-13));
}

TEST_CASE("open_along: all edges cut leave triangles of their own") {
  const Mesh mesh = shapes::torus(8);
  const Exec exec(2);
  const auto all = random_half_edges(static_cast<Index>(mesh.corner_vertex.size()), 1.0, 1);
  const CutSurface opened = open_along(exec, mesh.surface(), build_topology(exec, mesh.surface()), all);
  CHECK(opened.surface().num_vertices() == 3 * mesh.num_triangles());
  CHECK(opened.num_cut_edges == 3 * mesh.num_triangles() / 2);
  CHECK(build_topology(exec, opened.surface()).num_components == mesh.num_triangles());
}

TEST_CASE("open_along: an edge alone inside stays shut, two make a slit with one copy") {
  const Mesh mesh = shapes::height_field(7, shapes::flat);
  const Exec exec(1);
  const Topology topology = build_topology(exec, mesh.surface());
  const CutSurface shut = open_along(exec, mesh.surface(), topology, half_edges(mesh, {{16, 17}}));
  CHECK(shut.corner_vertex == mesh.corner_vertex);
  CHECK(shut.num_cut_edges == 0);
  CHECK(shut.cut_length == 0);

  const CutSurface slit = open_along(exec, mesh.surface(), topology, half_edges(mesh, {{16, 17}, {18, 17}}));
  CHECK(slit.position.size() == mesh.position.size() + 1);
  CHECK(slit.vertex_origin.back() == 17);
  CHECK(slit.num_cut_edges == 2);
  const Topology after = build_topology(exec, slit.surface());
  REQUIRE(after.num_loops() == 2);
  CHECK(after.loop_length[1] == doctest::Approx(2 * slit.cut_length));
  CHECK(euler(slit, after) == 0);
}

TEST_CASE(
    "open_along: a cut from border to border parts a disk in two, copies of half-edges change nothing") {
  const Mesh mesh = shapes::height_field(6, shapes::flat);
  const Exec exec(2);
  const Topology topology = build_topology(exec, mesh.surface());
  std::vector<std::pair<Index, Index>> column;
  for (Index j = 0; j < 5; ++j) column.emplace_back(2 + 6 * j, 2 + 6 * (j + 1));
  std::vector<Index> cut = half_edges(mesh, column);
  const CutSurface opened = open_along(exec, mesh.surface(), topology, cut);
  CHECK(build_topology(exec, opened.surface()).num_components == 2);
  CHECK(opened.position.size() == mesh.position.size() + 6);

  for (std::size_t k = 0; k < 5; ++k) cut.push_back(topology.corner_twin[cut[k]]);
  cut.push_back(cut[0]);
  for (Index c : topology.loop_corner) cut.push_back(c);  // open already
  const CutSurface again = open_along(exec, mesh.surface(), topology, cut);
  CHECK(again.corner_vertex == opened.corner_vertex);
  CHECK(again.num_cut_edges == 5);
}

TEST_CASE("open_along: a torus cut along a meridian is a tube, along a longitude too a disk") {
  const Index n = 10;
  const Mesh mesh = shapes::torus(n);
  const Exec exec(2);
  const Topology topology = build_topology(exec, mesh.surface());
  std::vector<std::pair<Index, Index>> edges;
  for (Index j = 0; j < n; ++j) edges.emplace_back(j * n, (j + 1) % n * n);
  const CutSurface tube = open_along(exec, mesh.surface(), topology, half_edges(mesh, edges));
  const Topology tube_topology = build_topology(exec, tube.surface());
  CHECK(tube_topology.num_loops() == 2);
  CHECK(euler(tube, tube_topology) == 0);
  for (Index i = 0; i < n; ++i) edges.emplace_back(i, (i + 1) % n);
  const CutSurface disk = open_along(exec, mesh.surface(), topology, half_edges(mesh, edges));
  const Topology disk_topology = build_topology(exec, disk.surface());
  CHECK(disk_topology.num_loops() == 1);
  CHECK(euler(disk, disk_topology) == 1);
  CHECK(std::count(disk.vertex_origin.begin(), disk.vertex_origin.end(), 0) == 4);
}

TEST_CASE("open_along: 1, 2 and 7 threads give the same bits") {
  const Mesh mesh = shapes::wavy_disk(60000);
  const Topology topology = build_topology(Exec(2), mesh.surface());
  const auto cut = random_half_edges(static_cast<Index>(mesh.corner_vertex.size()), 0.05, 5);
  const CutSurface one = open_along(Exec(1), mesh.surface(), topology, cut);
  for (int threads : {2, 7}) {
    const CutSurface many = open_along(Exec(threads), mesh.surface(), topology, cut);
    CHECK(many.corner_vertex == one.corner_vertex);
    CHECK(many.position == one.position);
    CHECK(many.vertex_origin == one.vertex_origin);
    CHECK(many.cut_length == one.cut_length);
  }
}
