#include "engine/features/sharp_edges.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/features/one_ring.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

struct Model {
  explicit Model(Mesh m) : mesh(std::move(m)), topology(build_topology(Exec(1), mesh.surface())) {}
  Mesh mesh;
  Topology topology;

  Result<FoundChain> sharp(double degrees, Vec3 near, int threads = 1) const {
    return chain_of_sharp_edges(Exec(threads), mesh.surface(), topology, "edge", {degrees, near});
  }
  std::vector<Vec3> positions(const std::vector<Index>& chain) const {
    std::vector<Vec3> result;
    for (const Index v : chain) result.push_back(mesh.position[v]);
    return result;
  }
};

/// A profile in the xy plane, counter-clockwise and star-shaped about the origin, drawn from z = 0 to 1, with
/// a lid on top; open below.
Mesh can(const std::vector<Vec2>& profile) {
  Mesh mesh;
  const auto n = static_cast<Index>(profile.size());
  for (const double z : {0.0, 1.0}) {
    for (const Vec2 p : profile) mesh.position.push_back({p.x, p.y, z});
  }
  mesh.position.push_back({0, 0, 1});
  for (Index i = 0; i < n; ++i) {
    const Index a = i, b = (i + 1) % n, c = a + n, d = b + n;
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, d, a, d, c, c, d, 2 * n});
  }
  return mesh;
}

std::vector<Vec2> circle(int n) {
  std::vector<Vec2> profile;
  for (int i = 0; i < n; ++i) profile.push_back(unit(2 * kPi * i / n));
  return profile;
}

double two_folds(double x, double y) { return 0.4 * (std::abs(x) + std::abs(y)); }
double one_fold(double x, double) { return std::abs(x); }

}  // namespace

TEST_CASE("sharp edges: an edge of a cube is alone, for at its ends two others turn off alike") {
  const Model model(shapes::cube(2));
  const FoundChain chain = model.sharp(40, {1.1, -0.2, -0.1}).value();
  CHECK(!chain.closed);
  CHECK(model.positions(chain.vertex) == std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}});
}

TEST_CASE("sharp edges: a fold is found from end to end, the same from each of its edges") {
  const Model model(shapes::height_field(9, one_fold, 0));
  for (const double y : {-1.0, -0.4, 0.1, 0.9}) {
    const FoundChain chain = model.sharp(60, {0.05, y, 0}).value();
    CHECK(!chain.closed);
    REQUIRE(chain.vertex.size() == 9);
    for (Index i = 0; i < 9; ++i) CHECK(model.mesh.position[chain.vertex[i]] == Vec3{0, -1 + 0.25 * i, 0});
  }
}

TEST_CASE("sharp edges: where folds cross, each goes straight on") {
  const Model model(shapes::height_field(9, two_folds, 0));
  for (const double s : {-0.9, -0.3, 0.2, 0.8}) {
    const FoundChain along_y = model.sharp(30, {0.01, s, 0.4 * std::abs(s)}).value();
    const FoundChain along_x = model.sharp(30, {s, 0.01, 0.4 * std::abs(s)}).value();
    REQUIRE(along_y.vertex.size() == 9);
    REQUIRE(along_x.vertex.size() == 9);
    for (const Index v : along_y.vertex) CHECK(model.mesh.position[v].x == 0);
    for (const Index v : along_x.vertex) CHECK(model.mesh.position[v].y == 0);
  }
}

TEST_CASE("sharp edges: the rim of a can closes, and starts at the vertex nearest to the point") {
  const int n = 40;
  const Model model(can(circle(n)));
  const FoundChain chain = model.sharp(40, {0, 1.2, 1}).value();
  CHECK(chain.closed);
  REQUIRE(chain.vertex.size() == n);
  CHECK(chain.vertex.front() == n + n / 4);
  std::vector<Index> sorted = chain.vertex;
  std::sort(sorted.begin(), sorted.end());
  for (Index i = 0; i < n; ++i) {
    CHECK(sorted[i] == n + i);
    CHECK(share_edge(model.mesh.surface(), model.topology, chain.vertex[i], chain.vertex[(i + 1) % n]));
  }
}

TEST_CASE("sharp edges: a loop with one branching corner closes there from whichever edge it grows") {
  std::vector<Vec2> drop = circle(40);
  drop[0] = {2, 0};  // a sharp tip, with a crease down the side
  const Model model(can(drop));
  for (const double angle : {0.05, 1.0, 3.0, 6.1}) {
    const Vec2 p = unit(angle);
    const FoundChain chain = model.sharp(80, {p.x, p.y, 1.1}).value();
    CHECK(chain.closed);
    CHECK(chain.vertex.size() == 40);
  }
  const FoundChain crease = model.sharp(80, {2, 0, 0.3}).value();
  CHECK(crease.vertex == std::vector<Index>{0, 40});
}

TEST_CASE("sharp edges: boundary edges are none, and a threshold above all states the sharpest") {
  const Model flat(shapes::height_field(5, shapes::flat)), cube(shapes::cube(1));
  const auto none = flat.sharp(0, {0, 0, 0});
  REQUIRE(!none);
  CHECK(none.error().code == ErrorCode::FeatureBroken);
  const auto above = cube.sharp(91, {0, 0, 0});
  REQUIRE(!above);
  CHECK(above.error().what ==
        "feature \"edge\": no edge is bent by more than 91 degrees; the sharpest has 90");
}

TEST_CASE("sharp edges: thresholds and points without meaning are refused") {
  const Model cube(shapes::cube(1));
  for (const double degrees : {-1.0, 180.0, kInfinity, std::nan("")}) CHECK(!cube.sharp(degrees, {0, 0, 0}));
  CHECK(!cube.sharp(40, {0, kInfinity, 0}));
}

TEST_CASE("sharp edges: neither numbering, scale nor threads change the path") {
  std::vector<Index> new_of_old;
  for (const Mesh& mesh : {can(circle(40)), shapes::height_field(9, two_folds, 0)}) {
    const Model model(mesh), other(shapes::relabelled(mesh, 3, new_of_old)),
        tiny(shapes::scaled(mesh, 0x1p-30));
    const Vec3 near{0.31, 0.02, 1.3};
    const FoundChain chain = model.sharp(30, near).value(), same = other.sharp(30, near).value();
    CHECK(model.positions(chain.vertex) == other.positions(same.vertex));
    CHECK(chain.closed == same.closed);
    CHECK(tiny.sharp(30, 0x1p-30 * near).value().vertex == chain.vertex);
    for (const int threads : {2, 7}) CHECK(model.sharp(30, near, threads).value().vertex == chain.vertex);
  }
}
