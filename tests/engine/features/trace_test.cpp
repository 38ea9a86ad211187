#include "engine/features/trace.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

struct Fixture {
  explicit Fixture(Mesh m)
      : mesh(std::move(m)),
        topology(build_topology(Exec(1), mesh.surface())),
        refined(mesh.surface(), topology) {}
  Mesh mesh;
  Topology topology;
  RefinedMesh refined;
};

Index nearest_vertex(const Mesh& mesh, Vec3 p) {
  Index best = 0;
  for (Index v = 1; v < mesh.num_vertices(); ++v) {
    if (norm(mesh.position[v] - p) < norm(mesh.position[best] - p)) best = v;
  }
  return best;
}

Vec3 place(const RefinedMesh& mesh, const Crossing& c) {
  const Vec3 tail = mesh.position(c.tail);
  return c.head == kNone ? tail : tail + c.s * (mesh.position(c.head) - tail);
}

double length_of(const RefinedMesh& mesh, Index from, Index to, const SurfacePath& path) {
  double length = 0;
  Vec3 at = mesh.position(from);
  for (const Crossing& c : path) {
    length += norm(place(mesh, c) - at);
    at = place(mesh, c);
  }
  return length + norm(mesh.position(to) - at);
}

}  // namespace

TEST_CASE("trace: on a flat mesh both ways of tracing give the straight segment") {
  Fixture f(shapes::height_field(25, shapes::flat, 0.3));
  shapes::Random random(3);
  for (int k = 0; k < 200; ++k) {
    const auto from = static_cast<Index>(random.uniform() * f.mesh.num_vertices());
    const auto to = static_cast<Index>(random.uniform() * f.mesh.num_vertices());
    if (from == to) continue;
    const Chord chord{f.mesh.position[from], f.mesh.position[to], 0.3};
    const double straight = norm(chord.to - chord.from);
    const auto in_plane = path_in_plane(f.refined, from, to, {0, 0, 1}, chord);
    const auto in_strip = path_in_strip(f.refined, from, to, chord);
    REQUIRE(in_strip);
    CHECK(length_of(f.refined, from, to, *in_strip) < 1.2 * straight);
    if (!in_plane) continue;  // along the jagged rim a plane may leave the mesh
    CHECK(length_of(f.refined, from, to, *in_plane) == Approx(straight).epsilon(1e-12));
  }
}

TEST_CASE("trace: a plane stops at a hole, a strip goes round its corner") {
  Fixture f(shapes::frame(17, shapes::flat));
  const Index from = nearest_vertex(f.mesh, {-0.9, -0.1, 0}), to = nearest_vertex(f.mesh, {-0.1, 0.9, 0});
  const Vec3 a = f.mesh.position[from], b = f.mesh.position[to];
  CHECK(!path_in_plane(f.refined, from, nearest_vertex(f.mesh, {0.9, -0.1, 0}), {0, 0, 1},
                       {a, {0.9, -0.1, 0}, 1}));
  const auto path = path_in_strip(f.refined, from, to, {a, b, 1});
  REQUIRE(path);
  // The corner of the hole that is nearest to the straight way.
  Vec3 corner{-2, 2, 0};
  for (Index k = f.topology.loop_begin[1]; k < f.topology.loop_begin[2]; ++k) {
    const Vec3 p = f.mesh.position[f.mesh.corner_vertex[f.topology.loop_corner[k]]];
    if (p.y - p.x > corner.y - corner.x || corner.x < -1) corner = p;
  }
  const double around = cross(Vec2{b.x - a.x, b.y - a.y}, Vec2{corner.x - a.x, corner.y - a.y}) > 0
                            ? norm(corner - a) + norm(b - corner)
                            : norm(b - a);
  const double length = length_of(f.refined, from, to, *path);
  CHECK(length > around - 1e-12);
  CHECK(length < 1.01 * around);  // shortest in its strip, which need not be the best one
}

TEST_CASE("trace: nothing is found outside the allowed distance") {
  Fixture f(shapes::frame(17, shapes::flat));
  const Index from = nearest_vertex(f.mesh, {-0.9, 0, 0}), to = nearest_vertex(f.mesh, {0.9, 0, 0});
  const Chord chord{f.mesh.position[from], f.mesh.position[to], 0.1};
  CHECK(!path_in_plane(f.refined, from, to, {0, 0, 1}, chord));
  CHECK(!path_in_strip(f.refined, from, to, chord));
}
