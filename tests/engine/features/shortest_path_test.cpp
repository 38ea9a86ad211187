#include "engine/features/shortest_path.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/features/one_ring.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// All distances along edges, by Floyd and Warshall; infinite between components.
std::vector<double> all_distances(const Mesh& mesh) {
  const auto n = static_cast<std::size_t>(mesh.num_vertices());
  std::vector<double> distance(n * n, kInfinity);
  for (std::size_t v = 0; v < n; ++v) distance[v * n + v] = 0;
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    const Index a = mesh.corner_vertex[c], b = mesh.corner_vertex[next_corner(c)];
    const double length = norm(mesh.position[a] - mesh.position[b]);
    distance[a * n + b] = distance[b * n + a] = length;
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j)
        distance[i * n + j] = std::min(distance[i * n + j], distance[i * n + k] + distance[k * n + j]);
    }
  }
  return distance;
}

void check_all_pairs(const Mesh& mesh) {
  const Topology topology = build_topology(Exec(1), mesh.surface());
  const std::vector<double> distance = all_distances(mesh);
  const auto n = static_cast<std::size_t>(mesh.num_vertices());
  const Surface surface = mesh.surface();
  ShortestPaths paths(surface, topology);
  for (Index a = 0; a < mesh.num_vertices(); ++a) {
    for (Index b = 0; b < mesh.num_vertices(); ++b) {
      if (a == b || distance[a * n + b] == kInfinity) continue;
      std::vector<Index> chain = paths.find(a, b, {});
      chain.insert(chain.begin(), a);
      REQUIRE(chain.back() == b);
      double length = 0;
      for (std::size_t i = 1; i < chain.size(); ++i) {
        REQUIRE(share_edge(surface, topology, chain[i - 1], chain[i]));
        length += norm(mesh.position[chain[i]] - mesh.position[chain[i - 1]]);
      }
      CHECK(length == doctest::Approx(distance[a * n + b]).epsilon(1e-12));
    }
  }
}

}  // namespace

TEST_CASE("shortest path: every pair is as near as all pairs at once say") {
  check_all_pairs(shapes::wavy_disk(100));
  check_all_pairs(shapes::frame(9, shapes::flat));
  check_all_pairs(shapes::height_field(6, shapes::flat, 0));
  check_all_pairs(shapes::torus(7));
  check_all_pairs(shapes::joined(shapes::cube(2), shapes::wavy_disk(40)));
}

TEST_CASE("shortest path: far from the origin and in tiny units") {
  Mesh mesh = shapes::scaled(shapes::wavy_disk(60), 1e-9);
  check_all_pairs(mesh);
  mesh = shapes::wavy_disk(60);
  for (Vec3& p : mesh.position) p = p + Vec3{1e6, -1e6, 1e6};
  check_all_pairs(mesh);
}

TEST_CASE("shortest path: barred vertices are kept off, and may shut the goal in") {
  const Mesh mesh = shapes::height_field(5, shapes::flat, 0);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  const Surface surface = mesh.surface();
  ShortestPaths paths(surface, topology);
  std::vector<std::uint8_t> barred(25, 0);
  for (const Index v : {2, 7, 12, 17}) barred[v] = 1;
  const std::vector<Index> around = paths.find(10, 14, barred);
  CHECK(std::find(around.begin(), around.end(), 22) != around.end());
  barred[22] = 1;
  CHECK(paths.find(10, 14, barred).empty());
  CHECK(paths.find(10, 12, barred) == std::vector<Index>{11, 12});
  CHECK(paths.find(10, 14, {}) == std::vector<Index>{11, 12, 13, 14});
}
