#include "engine/methods/intrinsic_triangulation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/methods/conformal_scales.hpp"
#include "kernels/intrinsic/milnor.hpp"
#include "tests/engine/methods/method_shapes.hpp"

using namespace planish;

namespace {

IntrinsicTriangulation triangulation_of(const Mesh& mesh) {
  IntrinsicTriangulation on{mesh.corner_vertex, build_topology(Exec(1), mesh.surface()), {}};
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c)
    on.log_length.push_back(std::log(
        norm(mesh.position[mesh.corner_vertex[next_corner(c)]] - mesh.position[mesh.corner_vertex[c]])));
  return on;
}

std::vector<double> random_scales(Index num_vertices, double size, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<double> u(num_vertices);
  for (double& x : u) x = size * (random.uniform() - 0.5);
  return u;
}

/// Of each edge its ends and its length, whatever the order of the triangles.
std::vector<std::array<double, 3>> edges_of(const IntrinsicTriangulation& on) {
  std::vector<std::array<double, 3>> edges;
  for (Index c = 0; c < static_cast<Index>(on.corner_vertex.size()); ++c) {
    const Index twin = on.topology.corner_twin[c];
    if (twin != kNone && twin < c) continue;
    const auto [a, b] = std::minmax(on.corner_vertex[c], on.corner_vertex[next_corner(c)]);
    edges.push_back({double(a), double(b), on.log_length[c]});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Twins share ends and length, and stars go round their vertices.
void check_consistent(const IntrinsicTriangulation& on) {
  const Topology& topology = on.topology;
  int wrong = 0;
  for (Index c = 0; c < static_cast<Index>(on.corner_vertex.size()); ++c) {
    const Index twin = topology.corner_twin[c];
    if (twin == kNone) continue;
    wrong += topology.corner_twin[twin] != c || on.log_length[c] != on.log_length[twin] ||
             on.corner_vertex[c] != on.corner_vertex[next_corner(twin)] ||
             on.corner_vertex[next_corner(c)] != on.corner_vertex[twin];
  }
  const auto num_vertices = static_cast<Index>(topology.star_begin.size()) - 1;
  for (Index v = 0; v < num_vertices; ++v) {
    const In<Index> star = slice(In<Index>(topology.star_corner), topology.stars().group(v));
    for (std::size_t k = 0; k < star.size(); ++k) {
      wrong += on.corner_vertex[star[k]] != v;
      const Index across = topology.corner_twin[previous_corner(star[k])];
      wrong += k + 1 < star.size() ? across != star[k + 1] : across != kNone && across != star[0];
    }
  }
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE(
    "intrinsic triangulation: of a plane it is Delaunay's, by empty circles, its lengths the distances") {
  Mesh mesh = shapes::height_field(14, shapes::flat, 0.3);
  for (Vec3& p : mesh.position) p = {6 * p.x + p.y, p.y, 0};  // sheared: far from Delaunay
  IntrinsicTriangulation on = triangulation_of(mesh);
  const auto flips = flip_to_delaunay(Exec(2), on);
  REQUIRE(flips);
  CHECK(*flips > 100);
  check_consistent(on);
  const auto at = [&](Index c) {
    return Vec2{mesh.position[on.corner_vertex[c]].x, mesh.position[on.corner_vertex[c]].y};
  };
  int inside = 0;
  for (Index c = 0; c < static_cast<Index>(on.corner_vertex.size()); ++c) {
    const Index twin = on.topology.corner_twin[c];
    CHECK(std::exp(on.log_length[c]) == doctest::Approx(norm(at(next_corner(c)) - at(c))).epsilon(1e-10));
    if (twin == kNone) continue;
    const Vec2 d = at(previous_corner(twin));
    const Vec2 p = at(c) - d, q = at(next_corner(c)) - d, r = at(previous_corner(c)) - d;
    const double in_circle = dot(p, p) * cross(q, r) + dot(q, q) * cross(r, p) + dot(r, r) * cross(p, q);
    inside += in_circle > 1e-9;
  }
  CHECK(inside == 0);
}

TEST_CASE("intrinsic triangulation: edges close under any scale factors where there is no boundary") {
  for (const double size : {1.0, 6.0, 14.0}) {
    CAPTURE(size);
    const Mesh torus = shapes::torus(12);
    IntrinsicTriangulation on = triangulation_of(torus);
    REQUIRE(flip_to_delaunay(Exec(1), on));
    const std::vector<double> u = random_scales(torus.num_vertices(), size, 5);
    const auto flips = flip_to_delaunay(Exec(1), u, on);
    REQUIRE(flips);
    CHECK(*flips > 0);
    check_consistent(on);
    int broken = 0;
    for (Index t = 0; t < on.num_triangles(); ++t) {
      std::array<double, 3> length;
      for (Index i = 0; i < 3; ++i) {
        const Index c = next_corner(3 * t + i);
        length[i] = on.log_length[c] + 0.5 * (u[on.corner_vertex[c]] + u[on.corner_vertex[next_corner(c)]]);
      }
      broken += triangle_angles(length).broken;
    }
    CHECK(broken == 0);
  }
}

TEST_CASE("intrinsic triangulation: it depends on the scale factors, not on the flips that led to them") {
  const Mesh torus = shapes::torus(10);
  IntrinsicTriangulation direct = triangulation_of(torus);
  REQUIRE(flip_to_delaunay(Exec(1), direct));
  IntrinsicTriangulation detour = direct;
  const std::vector<double> u = random_scales(torus.num_vertices(), 3, 1);
  for (const std::uint64_t seed : {7, 8, 9})
    REQUIRE(flip_to_delaunay(Exec(1), random_scales(torus.num_vertices(), 5, seed), detour));
  REQUIRE(flip_to_delaunay(Exec(1), u, direct));
  REQUIRE(flip_to_delaunay(Exec(1), u, detour));
  const auto one = edges_of(direct), other = edges_of(detour);
  REQUIRE(one.size() == other.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    CHECK(one[k][0] == other[k][0]);
    CHECK(one[k][1] == other[k][1]);
    CHECK(one[k][2] == doctest::Approx(other[k][2]).epsilon(1e-10));
  }
}

TEST_CASE("conformal energy: it does not jump where edges are flipped") {
  const Mesh torus = shapes::torus(8);
  IntrinsicTriangulation on = triangulation_of(torus);
  REQUIRE(flip_to_delaunay(Exec(1), on));
  ScaleNodes nodes;
  nodes.num_nodes = torus.num_vertices();
  nodes.target.assign(nodes.num_nodes, 2 * kPi);
  for (Index v = 0; v < nodes.num_nodes; ++v) nodes.node.push_back(v);
  const std::vector<double> along = random_scales(torus.num_vertices(), 4, 2);
  constexpr int kSteps = 2000;
  double integral = 0, slope_before = 0, first = 0, last = 0;
  Index flips = 0;
  for (int k = 0; k <= kSteps; ++k) {
    std::vector<double> u = along;
    for (double& x : u) x *= double(k) / kSteps;
    flips += *flip_to_delaunay(Exec(1), u, on);
    const ScaleProblem problem{on.corner_vertex, &on.topology, on.log_length, &nodes, {}};
    last = conformal_energy(Exec(1), problem, u);
    std::vector<double> defect(nodes.num_nodes, 2 * kPi);
    for (Index t = 0; t < on.num_triangles(); ++t) {
      std::array<double, 3> length;
      for (Index i = 0; i < 3; ++i) {
        const Index c = next_corner(3 * t + i);
        length[i] = on.log_length[c] + 0.5 * (u[on.corner_vertex[c]] + u[on.corner_vertex[next_corner(c)]]);
      }
      const TriangleAngles triangle = triangle_angles(length);
      for (Index i = 0; i < 3; ++i) defect[on.corner_vertex[3 * t + i]] -= triangle.angle[i];
    }
    double slope = 0;
    for (Index v = 0; v < nodes.num_nodes; ++v) slope += 0.5 * defect[v] * along[v];
    if (k == 0) first = last;
    if (k > 0) integral += 0.5 * (slope + slope_before) / kSteps;
    slope_before = slope;
  }
  CHECK(flips > 20);
  CHECK(last - first == doctest::Approx(integral).epsilon(1e-5));
}

TEST_CASE("intrinsic triangulation: 1, 2 and 7 threads give the same bits") {
  const Mesh mesh = shapes::wavy_disk(9000);
  const std::vector<double> u = random_scales(mesh.num_vertices(), 2, 3);
  const auto flipped = [&](int threads) {
    IntrinsicTriangulation on = triangulation_of(mesh);
    REQUIRE(flip_to_delaunay(Exec(threads), on));
    REQUIRE(flip_to_delaunay(Exec(threads), u, on));
    return on;
  };
  const IntrinsicTriangulation one = flipped(1);
  for (const int threads : {2, 7}) {
    const IntrinsicTriangulation other = flipped(threads);
    CHECK(one.corner_vertex == other.corner_vertex);
    CHECK(one.topology.star_corner == other.topology.star_corner);
    CHECK(std::memcmp(one.log_length.data(), other.log_length.data(),
                      sizeof(double) * one.log_length.size()) == 0);
  }
}
