#include "engine/verify/simple_boundary.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "engine/verify/overlaps.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// A mesh in the plane that is its own map.
struct Flat {
  std::vector<Index> corner_vertex;
  std::vector<Vec2> uv;

  void add_quad(Index a, Index b, Index c, Index d) {
    corner_vertex.insert(corner_vertex.end(), {a, b, c, a, c, d});
  }
  Topology topology() const {
    Mesh mesh;
    mesh.corner_vertex = corner_vertex;
    for (const Vec2 z : uv) mesh.position.push_back({z.x, z.y, 0});
    return build_topology(Exec(1), mesh.surface());
  }
  bool covers_once() const { return planish::covers_once(Exec(2), corner_vertex, topology(), uv); }
  std::vector<std::uint8_t> components() const {
    return components_covering_once(Exec(2), corner_vertex, topology(), uv);
  }
  Offset pairs() const { return find_overlaps(Exec(2), corner_vertex, uv).pairs; }
};

/// Quads along a curve, `turn` radians from one to the next, 0.1 wide.
Flat strip(In<double> turn) {
  Flat flat;
  Vec2 at{0, 0};
  double angle = 0;
  for (const double by : turn) {
    angle += 0.5 * by;
    at = at + 0.1 * unit(angle);
    angle += 0.5 * by;
    const Vec2 across = 0.05 * unit(angle + kPi / 2);
    flat.uv.insert(flat.uv.end(), {at - across, at + across});
  }
  for (Index k = 0; k + 3 < static_cast<Index>(flat.uv.size()); k += 2) flat.add_quad(k, k + 2, k + 3, k + 1);
  return flat;
}

/// Two square sheets, the second one larger, glued crosswise along a slit: a double cover of the smaller one that branches at the
/// ends of the slit, and whose two loops run the same way.
Flat crossed_sheets() {
  constexpr Index kSide = 12, kRow = kSide + 1, kSheet = kRow * kRow;
  Flat flat;
  const auto point = [](Index i, Index j) { return Vec2{2.0 * i / kSide - 1, 2.0 * j / kSide - 1}; };
  for (Index sheet = 0; sheet < 2; ++sheet) {
    for (Index k = 0; k < kSheet; ++k) {
      const Vec2 p = point(k % kRow, k / kRow);
      const double far = std::max(0.0, std::max(std::abs(p.x), std::abs(p.y)) - 0.5);
      flat.uv.push_back((1 + (sheet == 1 ? far : 0)) * p);
    }
  }
  std::vector<std::uint8_t> used(flat.uv.size(), 0);
  for (Index sheet = 0; sheet < 2; ++sheet) {
    for (Index j = 0; j < kSide; ++j) {
      for (Index i = 0; i < kSide; ++i) {
        const bool above = 2 * j >= kSide;
        const auto vertex = [&](Index x, Index y) {
          const Vec2 p = point(x, y);
          const bool on_slit = p.y == 0 && std::abs(p.x) <= 0.5, at_end = on_slit && std::abs(p.x) == 0.5;
          const Index of = at_end ? 0 : on_slit ? (above ? sheet : 1 - sheet) : sheet;
          const Index v = of * kSheet + y * kRow + x;
          used[v] = 1;
          return v;
        };
        flat.add_quad(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
      }
    }
  }
  std::vector<Index> number(flat.uv.size(), kNone);
  std::vector<Vec2> kept;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    number[v] = static_cast<Index>(kept.size());
    kept.push_back(flat.uv[v]);
  }
  for (Index& v : flat.corner_vertex) v = number[v];
  flat.uv = kept;
  return flat;
}

/// Eight cells around a hole, the last and the first one side by side but not joined.
Flat ring_that_touches() {
  Flat flat;
  std::map<std::array<Index, 3>, Index> vertex;
  for (const auto& [x, y] :
       std::vector<std::array<Index, 2>>{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}) {
    const auto at = [&, last = x == 0 && y == 1](Index i, Index j) {
      const auto [found, is_new] =
          vertex.try_emplace({i, j, last && j == 1}, static_cast<Index>(flat.uv.size()));
      if (is_new) flat.uv.push_back({double(i), double(j)});
      return found->second;
    };
    flat.add_quad(at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1));
  }
  return flat;
}

Flat square(Vec2 corner, double size) {
  Flat flat;
  flat.uv = {corner, corner + Vec2{size, 0}, corner + Vec2{size, size}, corner + Vec2{0, size}};
  flat.add_quad(0, 1, 2, 3);
  return flat;
}

Flat both(const Flat& a, const Flat& b) {
  Flat flat = a;
  for (const Index v : b.corner_vertex) flat.corner_vertex.push_back(v + static_cast<Index>(a.uv.size()));
  flat.uv.insert(flat.uv.end(), b.uv.begin(), b.uv.end());
  return flat;
}

}  // namespace

TEST_CASE("simple boundary: strips cover no point twice exactly where a search finds no overlap") {
  shapes::Random random(5);
  int once = 0, twice = 0;
  for (int k = 0; k < 300; ++k) {
    std::vector<double> turn(10 + k % 40);
    double curl = 0;
    for (double& t : turn) t = curl = std::clamp(curl + 0.3 * (2 * random.uniform() - 1), -0.7, 0.7);
    const Flat flat = strip(turn);
    const bool clear = flat.covers_once();
    CHECK(clear == (flat.pairs() == 0));
    ++(clear ? once : twice);
  }
  CHECK(once > 50);
  CHECK(twice > 50);
}

TEST_CASE("simple boundary: loops that are simple and run the same way cover twice") {
  const Flat flat = crossed_sheets();
  const Topology topology = flat.topology();
  REQUIRE(topology.manifold);
  REQUIRE(topology.num_loops() == 2);
  REQUIRE(topology.num_components == 1);
  REQUIRE(flat.pairs() > 0);
  CHECK_FALSE(flat.covers_once());
}

TEST_CASE("simple boundary: nothing is said where the boundary touches itself") {
  Flat ring = ring_that_touches();
  REQUIRE(ring.topology().num_loops() == 1);
  CHECK(ring.pairs() == 0);
  CHECK_FALSE(ring.covers_once());
  // In one point alone; and not at all.
  const auto left = std::find(ring.uv.rbegin(), ring.uv.rend(), Vec2{0, 1}),
             right = std::find(ring.uv.rbegin(), ring.uv.rend(), Vec2{1, 1});
  *left = {0.3, 1.2};
  *right = {0.75, 1};
  CHECK(ring.pairs() == 0);
  CHECK_FALSE(ring.covers_once());
  *right = {0.75, 1.125};
  CHECK(ring.covers_once());
}

TEST_CASE("simple boundary: nothing is said where it runs back over itself") {
  Flat fan;
  fan.uv = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
  for (Index k = 1; k < 5; ++k) fan.corner_vertex.insert(fan.corner_vertex.end(), {0, k, k + 1});
  CHECK(fan.pairs() == 0);
  CHECK_FALSE(fan.covers_once());
  fan.uv[5] = {1, -0.125};
  CHECK(fan.covers_once());
}

TEST_CASE("simple boundary: a triangle that is turned over inside is seen") {
  Flat flat;
  constexpr Index kRow = 5;
  for (Index k = 0; k < kRow * kRow; ++k) flat.uv.push_back({double(k % kRow), double(k / kRow)});
  for (Index j = 0; j + 1 < kRow; ++j) {
    for (Index i = 0; i + 1 < kRow; ++i)
      flat.add_quad(j * kRow + i, j * kRow + i + 1, (j + 1) * kRow + i + 1, (j + 1) * kRow + i);
  }
  CHECK(flat.covers_once());
  flat.uv[12] = {3.5, 2};
  CHECK_FALSE(flat.covers_once());
}

TEST_CASE("simple boundary: a ring around a hole covers once, its image under z^2 does not") {
  constexpr Index kAround = 40;
  Flat ring, doubled;
  for (Index k = 0; k < kAround; ++k) {
    for (const double radius : {1.0, 1.5}) {
      ring.uv.push_back(radius * unit(2 * kPi * k / kAround));
      doubled.uv.push_back(radius * unit(4 * kPi * k / kAround));
    }
    const Index a = 2 * k, b = (2 * k + 2) % (2 * kAround);
    ring.add_quad(a, a + 1, b + 1, b);
  }
  doubled.corner_vertex = ring.corner_vertex;
  CHECK(ring.pairs() == 0);
  CHECK(ring.covers_once());
  CHECK_FALSE(doubled.covers_once());
}

TEST_CASE("simple boundary: components are judged by themselves, the whole by their boxes too") {
  const Flat apart = both(square({0, 0}, 1), square({2, 0}, 1)),
             inside = both(square({0, 0}, 3), square({1, 1}, 1));
  CHECK(apart.components() == std::vector<std::uint8_t>{1, 1});
  CHECK(apart.covers_once());
  CHECK(inside.components() == std::vector<std::uint8_t>{1, 1});
  CHECK_FALSE(inside.covers_once());
  const Flat curled = strip(std::vector<double>(30, 0.5));
  CHECK(both(square({5, 5}, 1), curled).components() == std::vector<std::uint8_t>{1, 0});
}
