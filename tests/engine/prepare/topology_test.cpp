#include "engine/prepare/topology.hpp"

#include <doctest/doctest.h>

#include "kernels/intrinsic/curvature.hpp"
#include "kernels/intrinsic/lengths.hpp"
#include "kernels/topology/stars.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

std::vector<double> angle_sums_of(const Mesh& mesh, const Topology& topology) {
  std::vector<RestFrame> frame(mesh.num_triangles());
  std::vector<double> angle(mesh.corner_vertex.size()), sum(mesh.position.size());
  rest_frames({0, mesh.num_triangles()}, mesh.position, mesh.corner_vertex, frame);
  corner_angles({0, mesh.num_triangles()}, frame, angle);
  angle_sums({0, mesh.num_vertices()}, angle, topology.stars(), topology.star_corner, sum);
  return sum;
}

}  // namespace

TEST_CASE("topology: twins are mutual, run the other way, and stars turn counter-clockwise through them") {
  const Mesh mesh = shapes::wavy_disk(2000);
  const Topology topology = build_topology(Exec(2), mesh.surface());
  REQUIRE(topology.manifold);
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    const Index twin = topology.corner_twin[c];
    if (twin == kNone) continue;
    CHECK(topology.corner_twin[twin] == c);
    CHECK(mesh.corner_vertex[twin] == mesh.corner_vertex[next_corner(c)]);
    CHECK(mesh.corner_vertex[next_corner(twin)] == mesh.corner_vertex[c]);
  }
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    const Range star = topology.stars().group(v);
    for (Index k = star.begin; k + 1 < star.end; ++k) {
      CHECK(rotate_ccw(topology.star_corner[k], topology.corner_twin) == topology.star_corner[k + 1]);
    }
    for (Index k = star.begin; k < star.end; ++k) CHECK(mesh.corner_vertex[topology.star_corner[k]] == v);
  }
}

TEST_CASE("topology: a cube is closed, each corner has angle defect pi/2 and the eight sum to 4 pi") {
  const Mesh mesh = shapes::cube(2);
  const Topology topology = build_topology(Exec(1), mesh.surface());
  CHECK(topology.manifold);
  CHECK(topology.num_loops() == 0);
  CHECK(topology.num_edges == 18);
  double total = 0;
  for (const double sum : angle_sums_of(mesh, topology)) {
    CHECK(2 * kPi - sum == doctest::Approx(kPi / 2));
    total += 2 * kPi - sum;
  }
  CHECK(total == doctest::Approx(4 * kPi));
}

TEST_CASE("topology: Gauss-Bonnet holds on disk, frame and torus") {
  for (const Mesh& mesh : {shapes::wavy_disk(5000),
                           shapes::frame(30, [](double x, double y) { return x * y; }), shapes::torus(20)}) {
    const Topology topology = build_topology(Exec(2), mesh.surface());
    REQUIRE(topology.manifold);
    const auto sum = angle_sums_of(mesh, topology);
    double curvature = 0;
    for (Index v = 0; v < mesh.num_vertices(); ++v) {
      curvature += (topology.is_boundary(v) ? kPi : 2 * kPi) - sum[v];
    }
    const Index euler = mesh.num_vertices() - topology.num_edges + mesh.num_triangles();
    CHECK(curvature == doctest::Approx(2 * kPi * euler).epsilon(1e-9));
  }
}

TEST_CASE("topology: a frame has its outer loop first, surface on the left of both loops") {
  const Mesh mesh = shapes::frame(20, shapes::flat);
  const Topology topology = build_topology(Exec(2), mesh.surface());
  REQUIRE(topology.num_loops() == 2);
  CHECK(topology.loop_length[0] == doctest::Approx(8));
  for (Index l = 0; l < 2; ++l) {
    double area = 0;
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(l))) {
      const Vec3 p = mesh.position[mesh.corner_vertex[c]],
                 q = mesh.position[mesh.corner_vertex[next_corner(c)]];
      area += 0.5 * (p.x * q.y - p.y * q.x);
    }
    CHECK((area > 0) == (l == 0));
  }
}

TEST_CASE("topology: components are numbered by their first triangle") {
  const Mesh mesh =
      shapes::joined(shapes::wavy_disk(200), shapes::joined(shapes::cube(1), shapes::wavy_disk(50)));
  const Topology topology = build_topology(Exec(2), mesh.surface());
  CHECK(topology.num_components == 3);
  CHECK(topology.triangle_component.front() == 0);
  CHECK(topology.triangle_component.back() == 2);
}

TEST_CASE("topology: 1, 2 and 7 threads give the same arrays") {
  const Mesh mesh = shapes::wavy_disk(40000);
  const Topology one = build_topology(Exec(1), mesh.surface());
  for (const int threads : {2, 7}) {
    const Topology other = build_topology(Exec(threads), mesh.surface());
    CHECK(other.corner_twin == one.corner_twin);
    CHECK(other.star_corner == one.star_corner);
    CHECK(other.triangle_component == one.triangle_component);
    CHECK(other.loop_corner == one.loop_corner);
  }
}
