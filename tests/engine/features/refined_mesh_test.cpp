#include "engine/features/refined_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

constexpr double kShare = 1e-3;

struct Fixture {
  explicit Fixture(Mesh m)
      : mesh(std::move(m)),
        topology(build_topology(Exec(1), mesh.surface())),
        refined(mesh.surface(), topology) {}
  Mesh mesh;
  Topology topology;
  RefinedMesh refined;
};

/// Every corner is found in the star of its vertex, and twins agree on their ends.
void check_links(const RefinedMesh& mesh) {
  std::vector<std::size_t> corners(mesh.num_vertices(), 0);
  for (Index c = 0; c < 3 * mesh.num_triangles(); ++c) {
    ++corners[mesh.vertex(c)];
    const Index twin = mesh.twin(c);
    if (twin == kNone) continue;
    REQUIRE(mesh.twin(twin) == c);
    REQUIRE(mesh.vertex(twin) == mesh.vertex(next_corner(c)));
    REQUIRE(mesh.vertex(next_corner(twin)) == mesh.vertex(c));
  }
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    std::set<Index> star;
    mesh.visit_star(v, [&](Index c) {
      REQUIRE(mesh.vertex(c) == v);
      REQUIRE(star.insert(c).second);
      return false;
    });
    REQUIRE(star.size() == corners[v]);
  }
}

double opposite_angle(const RefinedMesh& mesh, Index c) {
  const Vec3 apex = mesh.position(mesh.vertex(previous_corner(c)));
  const Vec3 a = mesh.position(mesh.vertex(c)) - apex, b = mesh.position(mesh.vertex(next_corner(c))) - apex;
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

}  // namespace

TEST_CASE("refined mesh: a point moves to a vertex or an edge within the tolerance, and only then") {
  Fixture f(shapes::triangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0}));
  bool snapped = false;
  CHECK(f.refined.insert({0, {1 - 2e-4, 2e-4, 0}}, kShare, snapped) == 0);
  CHECK(snapped);
  CHECK(f.refined.insert({0, {0, 1, 0}}, kShare, snapped) == 1);
  CHECK(!snapped);
  const Index on_edge = f.refined.insert({0, {0.5, 0.4999, 0.0001}}, kShare, snapped);
  CHECK(snapped);
  CHECK(f.refined.position(on_edge) == Vec3{0.9998, 0, 0});
  const Index inside = f.refined.insert({0, {0.4, 0.2, 0.4}}, kShare, snapped);
  CHECK(!snapped);
  CHECK(norm(f.refined.position(inside) - Vec3{0.4, 0.4, 0}) < 1e-15);
  CHECK(f.refined.insert({0, {0.4, 0.2, 0.4}}, kShare, snapped) == inside);
  CHECK(f.refined.num_triangles() == 4);
  check_links(f.refined);
}

TEST_CASE("refined mesh: random points and edge splits keep links, areas and places") {
  Fixture f(shapes::height_field(
      8, [](double x, double y) { return 0.2 * x * y; }, 0.3));
  shapes::Random random(5);
  for (int k = 0; k < 400; ++k) {
    const double a = random.uniform(), b = (1 - a) * random.uniform();
    bool snapped = false;
    f.refined.insert({static_cast<Index>(random.uniform() * f.mesh.num_triangles()), {1 - a - b, a, b}},
                     kShare, snapped);
    const auto corner = static_cast<Index>(random.uniform() * 3 * f.refined.num_triangles());
    f.refined.split_edge(corner, random.uniform(), kShare);
  }
  check_links(f.refined);
  f.refined.improve();
  check_links(f.refined);
  Index checked = 0;
  for (Index c = 0; c < 3 * f.refined.num_triangles(); ++c) {
    const Index twin = f.refined.twin(c);
    if (twin == kNone || f.refined.triangle_origin(c / 3) != f.refined.triangle_origin(twin / 3)) continue;
    CHECK(opposite_angle(f.refined, c) + opposite_angle(f.refined, twin) < kPi + 1e-6);
    ++checked;
  }
  CHECK(checked > 1000);
}

TEST_CASE("refined mesh: the splits of a constrained edge are followed in either direction") {
  Fixture f(shapes::triangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0}));
  f.refined.constrain(f.refined.edge_between(0, 1));
  const Index middle = f.refined.split_edge(f.refined.edge_between(0, 1), 0.5, kShare);
  const Index edge = f.refined.edge_between(1, middle);
  const Index quarter = f.refined.split_edge(edge, 0.5, kShare);
  CHECK(f.refined.is_constrained(f.refined.edge_between(quarter, 1)));
  CHECK(!f.refined.is_constrained(f.refined.edge_between(quarter, 2)));
  std::vector<Index> chain;
  f.refined.follow(1, 0, chain);
  CHECK(chain == std::vector<Index>{quarter, middle, 0});
}

TEST_CASE("refined mesh: a point on a crowded edge is found again, though rounding puts it beyond the edge") {
  Fixture f(shapes::triangle({0, 0, 0}, {2, 0, 0}, {0.3, 1, 0}));
  bool snapped = false;
  std::vector<Index> placed;
  std::vector<SurfacePoint> points;
  shapes::Random random(8);
  for (int k = 0; k < 200; ++k) {
    const double b = random.uniform(), tiny = 4e-16 * (random.uniform() - 0.5);
    points.push_back({0, {tiny, b, 1 - b - tiny}});
    placed.push_back(f.refined.insert(points.back(), kShare, snapped));
  }
  for (int k = 0; k < 200; ++k) {
    const Vec3 b = points[k].barycentric;
    const Vec3 place = b.y * f.mesh.position[1] + b.z * f.mesh.position[2];
    CHECK(norm(f.refined.position(placed[k]) - place) < 1.01e-3);
    CHECK(norm(f.refined.position(f.refined.insert(points[k], kShare, snapped)) - place) < 1.01e-3);
  }
}
