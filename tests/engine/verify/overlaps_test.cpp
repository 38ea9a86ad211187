#include "engine/verify/overlaps.hpp"

#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

std::vector<Vec2> dropped(const Mesh& mesh) {
  std::vector<Vec2> uv;
  for (const Vec3 p : mesh.position) uv.push_back({p.x, p.y});
  return uv;
}

Overlaps overlaps_of(const Mesh& mesh, const std::vector<Vec2>& uv) {
  return find_overlaps(Exec(2), mesh.corner_vertex, uv);
}

bool strictly_inside(Vec2 p, const Vec2* t) {
  const double side = cross(t[1] - t[0], t[2] - t[0]) > 0 ? 1 : -1;
  return side * cross(t[1] - t[0], p - t[0]) > 0 && side * cross(t[2] - t[1], p - t[1]) > 0 &&
         side * cross(t[0] - t[2], p - t[2]) > 0;
}

}  // namespace

TEST_CASE("overlaps: a planar mesh has none, its area is its own") {
  const Mesh mesh = shapes::height_field(40, shapes::flat);
  const Overlaps o = overlaps_of(mesh, dropped(mesh));
  CHECK(o.pairs == 0);
  CHECK(o.map_area == Approx(4));
}

TEST_CASE("overlaps: two equal triangles on one another share all of their area") {
  const Mesh one = shapes::triangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  const Mesh both = shapes::joined(one, one);
  const Overlaps o = overlaps_of(both, dropped(both));
  CHECK(o.pairs == 1);
  CHECK(o.common_area == Approx(1));
  CHECK(o.map_area == Approx(2));
}

TEST_CASE("overlaps: touching in an edge, a corner or along a line is none") {
  const Mesh a = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (const Mesh& b :
       {shapes::triangle({1, 0, 0}, {1, 1, 0}, {0, 1, 0}), shapes::triangle({1, 0, 0}, {2, 0, 0}, {2, 1, 0}),
        shapes::triangle({0.25, 0, 0}, {0.5, -1, 0}, {0.75, 0, 0})}) {
    const Mesh both = shapes::joined(a, b);
    CHECK(overlaps_of(both, dropped(both)).pairs == 0);
  }
}

TEST_CASE("overlaps: the smallest step beyond touching is found") {
  const Mesh a = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Mesh b = shapes::triangle({std::nextafter(0.5, 0), 0.5, 0}, {1, 1, 0}, {0.5, 2, 0});
  const Mesh both = shapes::joined(a, b);
  CHECK(overlaps_of(both, dropped(both)).pairs == 1);
}

TEST_CASE("overlaps: triangles with a common vertex and triangles without area do not count") {
  Mesh fan = shapes::joined(shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                            shapes::triangle({0, 0, 0}, {1, 0.1, 0}, {0, 1, 0}));
  fan.corner_vertex[3] = 0;
  CHECK(overlaps_of(fan, dropped(fan)).pairs == 0);
  const Mesh flat = shapes::joined(shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                   shapes::triangle({0.1, 0.1, 0}, {0.2, 0.2, 0}, {0.4, 0.4, 0}));
  CHECK(overlaps_of(flat, dropped(flat)).pairs == 0);
}

TEST_CASE("overlaps: pairs and common area of random triangles agree with brute force") {
  shapes::Random random(21);
  Mesh soup;
  for (int t = 0; t < 60; ++t) {
    const auto point = [&] { return Vec3{random.uniform(), random.uniform(), 0}; };
    soup = shapes::joined(soup, shapes::triangle(point(), point(), point()));
  }
  const auto uv = dropped(soup);
  const Overlaps o = overlaps_of(soup, uv);
  // Common area by sampling: each sample in k triangles counts k (k - 1) / 2 pairs.
  constexpr int kSamples = 200'000;
  double pairs_at_sample = 0;
  for (int s = 0; s < kSamples; ++s) {
    const Vec2 p{random.uniform(), random.uniform()};
    int k = 0;
    for (Index t = 0; t < soup.num_triangles(); ++t) k += strictly_inside(p, &uv[3 * t]);
    pairs_at_sample += k * (k - 1) / 2.0;
  }
  CHECK(o.common_area == Approx(pairs_at_sample / kSamples).epsilon(0.02));
  CHECK(o.pairs > 300);
  CHECK(find_overlaps(Exec(7), soup.corner_vertex, uv).common_area == o.common_area);
}

TEST_CASE("overlaps: the triangles of all pairs are found, each once, beyond the pairs that are listed") {
  Mesh mesh;
  for (int k = 0; k < 100; ++k) {
    const double x = 0.7 * k;  // each meets the next one
    mesh = shapes::joined(mesh, shapes::triangle({x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}));
  }
  mesh = shapes::joined(mesh, shapes::triangle({-9, 0, 0}, {-8, 0, 0}, {-9, 1, 0}));
  const std::vector<Vec2> uv = dropped(mesh);
  CHECK(overlaps_of(mesh, uv).pairs == 99);
  std::vector<Index> expected(100);
  for (Index t = 0; t < 100; ++t) expected[t] = t;
  for (const int threads : {1, 2, 7})
    CHECK(overlapping_triangles(Exec(threads), mesh.corner_vertex, uv) == expected);
}

TEST_CASE("overlaps: a strip wound twice around covers twice") {
  // A spiral ring: second turn exactly over the first but a little shifted outwards.
  Mesh ring;
  constexpr Index kSteps = 200;
  for (Index i = 0; i <= kSteps; ++i) {
    const double a = 4 * kPi * i / kSteps, shift = 0.05 * i / kSteps;
    ring.position.push_back({(1 + shift) * std::cos(a), (1 + shift) * std::sin(a), 0});
    ring.position.push_back({(2 + shift) * std::cos(a), (2 + shift) * std::sin(a), 0});
  }
  for (Index i = 0; i < kSteps; ++i) {
    const Index a = 2 * i;
    ring.corner_vertex.insert(ring.corner_vertex.end(), {a, a + 1, a + 3, a, a + 3, a + 2});
  }
  const Overlaps o = overlaps_of(ring, dropped(ring));
  CHECK(o.common_area / o.map_area == Approx(0.5).epsilon(0.05));
}

TEST_CASE("overlaps: pairs are listed in ascending order, the first of many") {
  const Mesh one = shapes::triangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  Mesh pile = one;
  for (Index copies = 1; copies < 40; ++copies) pile = shapes::joined(pile, one);
  const Overlaps o = overlaps_of(pile, dropped(pile));
  CHECK(o.pairs == 40 * 39 / 2);
  REQUIRE(o.first.size() == kMaxListedIds);
  for (Index k = 0; k < 39; ++k) CHECK(o.first[k] == std::array<Index, 2>{0, k + 1});
  CHECK(o.first[39] == std::array<Index, 2>{1, 2});
  CHECK(o.first[63] == std::array<Index, 2>{1, 26});
}
