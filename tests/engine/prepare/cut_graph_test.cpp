#include "engine/prepare/cut_graph.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "engine/prepare/cut.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// Border of the union of unit cubes at the cells where solid(i, j, k); vertices moved by up to `jitter`.
template <class Solid>
Mesh blocks(Index n, Solid&& solid, double jitter = 0) {
  Mesh mesh;
  shapes::Random random(11);
  std::map<std::tuple<Index, Index, Index>, Index> number;
  const auto vertex = [&](std::array<Index, 3> p) {
    const auto [it, is_new] = number.try_emplace({p[0], p[1], p[2]}, mesh.num_vertices());
    if (is_new) {
      const auto moved = [&](Index x) { return x + jitter * (2 * random.uniform() - 1); };
      const double x = moved(p[0]), y = moved(p[1]), z = moved(p[2]);
      mesh.position.push_back({x, y, z});
    }
    return it->second;
  };
  const auto is_solid = [&](std::array<Index, 3> p) {
    return std::ranges::all_of(p, [&](Index x) { return x >= 0 && x < n; }) && solid(p[0], p[1], p[2]);
  };
  for (Index cell = 0; cell < n * n * n; ++cell) {
    const std::array<Index, 3> p = {cell % n, cell / n % n, cell / n / n};
    if (!is_solid(p)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      for (int up : {0, 1}) {
        auto neighbour = p;
        neighbour[axis] += up ? 1 : -1;
        if (is_solid(neighbour)) continue;
        std::array<Index, 4> quad{};
        for (int k = 0; k < 4; ++k) {
          auto q = p;
          q[axis] += up;
          q[(axis + 1) % 3] += k == 1 || k == 2;
          q[(axis + 2) % 3] += k >= 2;
          quad[up ? k : 3 - k] = vertex(q);
        }
        mesh.corner_vertex.insert(mesh.corner_vertex.end(),
                                  {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
      }
    }
  }
  return mesh;
}

/// A plate with `tunnels` square tunnels through it: genus = tunnels, at most 9.
Mesh plate_with_tunnels(Index tunnels, double jitter) {
  return blocks(
      13,
      [=](Index i, Index j, Index k) {
        const bool hole = i % 4 >= 2 && j % 4 >= 2 && i / 4 + 3 * (j / 4) < tunnels && i < 12 && j < 12;
        return k < 2 && !hole;
      },
      jitter);
}

/// Without the triangles for which drop(t); vertices that lose all of theirs go too.
template <class Drop>
Mesh without(const Mesh& mesh, Drop&& drop) {
  Mesh rest;
  std::vector<Index> number(mesh.position.size(), kNone);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    if (drop(t)) continue;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      Index& v = number[mesh.corner_vertex[c]];
      if (v == kNone) {
        v = rest.num_vertices();
        rest.position.push_back(mesh.position[mesh.corner_vertex[c]]);
      }
      rest.corner_vertex.push_back(v);
    }
  }
  return rest;
}

struct Opened {
  CutGraph graph;
  CutSurface surface;
  Topology before, after;
  Index euler = 0, genus = 0;  // after; the genus is summed over components
};

Opened open(const Mesh& mesh, In<Index> preferred = {}, const CutGraphOptions& options = {},
            int threads = 2) {
  const Exec exec(threads);
  Opened o;
  o.before = build_topology(exec, mesh.surface());
  REQUIRE(o.before.manifold);
  o.graph = find_cut_graph(exec, mesh.surface(), o.before, preferred, options);
  o.surface = open_along(exec, mesh.surface(), o.before, o.graph.corner);
  o.after = build_topology(exec, o.surface.surface());
  REQUIRE(o.after.manifold);
  o.euler = o.surface.surface().num_vertices() - o.after.num_edges + mesh.num_triangles();
  o.genus = (2 * o.after.num_components - o.after.num_loops() - o.euler) / 2;
  CHECK(o.surface.num_cut_edges == static_cast<Index>(o.graph.corner.size()));
  CHECK(o.surface.cut_length == doctest::Approx(o.graph.length).epsilon(1e-12));
  CHECK(std::is_sorted(o.graph.corner.begin(), o.graph.corner.end()));
  return o;
}

void check_disk(const Opened& o) {
  CHECK(o.after.num_components == 1);
  CHECK(o.after.num_loops() == 1);
  CHECK(o.euler == 1);
}

/// Cut edges at each vertex.
std::vector<Index> degrees(const Mesh& mesh, const CutGraph& graph) {
  std::vector<Index> degree(mesh.position.size(), 0);
  for (Index c : graph.corner) {
    ++degree[mesh.corner_vertex[c]], ++degree[mesh.corner_vertex[next_corner(c)]];
  }
  return degree;
}

std::vector<Index> half_edges_where(const Mesh& mesh, auto&& both_ends) {
  std::vector<Index> found;
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    if (both_ends(mesh.corner_vertex[c], mesh.corner_vertex[next_corner(c)])) found.push_back(c);
  }
  return found;
}

const CutGraphOptions kNothingSharp{.sharp_degrees = 180};

}  // namespace

TEST_CASE("cut graph: a component with boundary and without handles needs none") {
  for (const Mesh& mesh : {shapes::wavy_disk(500), shapes::frame(15, shapes::flat),
                           shapes::joined(shapes::wavy_disk(100), shapes::frame(12, shapes::flat))}) {
    const Opened o = open(mesh);
    CHECK(o.graph.corner.empty());
    CHECK(o.graph.length == 0);
    CHECK(o.surface.corner_vertex == mesh.corner_vertex);
  }
}

TEST_CASE("cut graph: closed surfaces without handles open along a path to a disk") {
  Mesh tetrahedron, pillow;
  tetrahedron.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.corner_vertex = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  pillow.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  pillow.corner_vertex = {0, 1, 2, 0, 2, 1};
  const auto lump = [](Index i, Index j, Index k) { return i + j + k < 6; };
  for (const Mesh& mesh : {tetrahedron, pillow, shapes::cube(2), blocks(6, lump, 0.2)}) {
    const Opened o = open(mesh);
    check_disk(o);
    const auto degree = degrees(mesh, o.graph);
    CHECK(std::count(degree.begin(), degree.end(), 1) == 2);
    CHECK(std::ranges::all_of(degree, [](Index d) { return d <= 2; }));
    CHECK(o.graph.corner.size() >= 2);
  }
}

TEST_CASE(
    "cut graph: the path over a box runs along its creases, between ends farther apart than a face is wide") {
  const Mesh mesh = blocks(12, [](Index, Index j, Index k) { return j < 5 && k < 3; });
  const Opened o = open(mesh);
  check_disk(o);
  CHECK(o.graph.length > std::hypot(12.0, 5.0));
  CHECK(o.graph.length <= 12 + 5 + 3);
  const auto on_crease = [&](Index v) {
    const Vec3 p = mesh.position[v];
    return (p.x == 0 || p.x == 12) + (p.y == 0 || p.y == 5) + (p.z == 0 || p.z == 3) >= 2;
  };
  const auto degree = degrees(mesh, o.graph);
  for (Index v = 0; v < mesh.num_vertices(); ++v) CHECK((degree[v] == 0 || on_crease(v)));
}

TEST_CASE("cut graph: a torus is cut along a shortest meridian and the inner equator") {
  const Index n = 24;
  const Opened o = open(shapes::torus(n), {}, kNothingSharp);
  check_disk(o);
  const double circle = 2 * n * std::sin(kPi / n);  // n chords of the unit circle
  CHECK(o.graph.length == doctest::Approx(2 * circle).epsilon(1e-9));
}

TEST_CASE("cut graph: preferred edges are taken though they are longer") {
  const Index n = 24;
  const Mesh mesh = shapes::torus(n);
  const auto outer_equator = half_edges_where(
      mesh, [&](Index a, Index b) { return a < n && b < n && (b == (a + 1) % n || a == (b + 1) % n); });
  REQUIRE(outer_equator.size() == 2 * n);
  const Opened o = open(mesh, outer_equator, kNothingSharp);
  check_disk(o);
  Index taken = 0;
  for (Index c : outer_equator) {
    taken += std::binary_search(o.graph.corner.begin(), o.graph.corner.end(), c);
  }
  CHECK(taken == n);
  CHECK(o.graph.length == doctest::Approx(2 * n * std::sin(kPi / n) * (3 + 1)).epsilon(1e-9));
}

TEST_CASE("cut graph: genus 1 to 9 open to a disk without dangling edges, near the tunnels' girths") {
  for (const Index genus : {1, 2, 3, 5, 9}) {
    const Mesh mesh = plate_with_tunnels(genus, 0.15);
    const Opened o = open(mesh, {}, kNothingSharp);
    REQUIRE(o.before.num_edges - mesh.num_vertices() - mesh.num_triangles() == 2 * genus - 2);
    check_disk(o);
    CHECK(std::ranges::none_of(degrees(mesh, o.graph), [](Index d) { return d == 1; }));
    // A loop around each tunnel's wall (8), and one through it and back over two units of land (8).
    CHECK(o.graph.length < 1.02 * (8 + 8) * genus);
  }
}

TEST_CASE("cut graph: a cut torus keeps its hole, and the hole its border") {
  const Index n = 20;
  // A hole across the inner equator, where the shortest cut would go.
  const Mesh mesh = without(shapes::torus(n), [&](Index t) {
    const Index i = t / 2 % n, j = t / 2 / n;
    return i < 3 && j >= 8 && j < 12;
  });
  const Opened o = open(mesh, {}, kNothingSharp);
  REQUIRE(o.before.num_loops() == 1);
  CHECK(o.after.num_components == 1);
  CHECK(o.genus == 0);
  REQUIRE(o.after.num_loops() == 2);
  CHECK(o.after.loop_length[1] == doctest::Approx(o.before.loop_length[0]).epsilon(1e-12));
  CHECK(o.after.loop_length[0] == doctest::Approx(2 * o.graph.length).epsilon(1e-12));
}

TEST_CASE("cut graph: holes strewn at random are kept while there is room, handles are cut in any case") {
  const Mesh full = plate_with_tunnels(3, 0.15);
  for (const double share : {0.01, 0.1, 1.0}) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      shapes::Random random(seed);
      std::vector<char> taken(full.position.size(), 0);  // holes of one triangle, without common vertices
      const Mesh mesh = without(full, [&](Index t) {
        const auto corners = In<Index>(full.corner_vertex).subspan(3 * t, 3);
        if (std::ranges::any_of(corners, [&](Index v) { return taken[v]; }) || random.uniform() >= share)
          return false;
        for (Index v : corners) taken[v] = 1;
        return true;
      });
      const Opened o = open(mesh, {}, kNothingSharp);
      REQUIRE(o.before.num_loops() > 0);
      CHECK(o.after.num_components == 1);
      CHECK(o.genus == 0);
      CHECK(o.after.num_loops() <= o.before.num_loops() + 1);
      if (share < 0.05) CHECK(o.after.num_loops() == o.before.num_loops() + 1);
    }
  }
}

TEST_CASE("cut graph: where every vertex is on a hole, handles are still cut") {
  const Index n = 12;
  const Mesh mesh =
      without(shapes::torus(n), [&](Index t) { return t / 2 % n % 2 == 0 && t / 2 / n % 2 == 0; });
  const Opened o = open(mesh);
  REQUIRE(o.before.num_loops() == n * n / 4);
  CHECK(o.after.num_components == 1);
  CHECK(o.genus == 0);
  CHECK(o.after.num_loops() >= n * n / 4 + 1 - n);  // a meridian and a longitude cross some n holes
}

TEST_CASE("cut graph: components are cut each by itself") {
  const Mesh a = shapes::torus(10), b = shapes::cube(3), c = shapes::frame(12, shapes::flat),
             d = plate_with_tunnels(2, 0.1);
  const Opened o = open(shapes::joined(shapes::joined(a, b), shapes::joined(c, d)));
  CHECK(o.after.num_components == 4);
  CHECK(o.after.num_loops() == 3 + 2);
  CHECK(o.genus == 0);
  CHECK(o.euler == 3);
  const double sum = open(a).graph.length + open(b).graph.length + open(d).graph.length;
  CHECK(o.graph.length == doctest::Approx(sum).epsilon(1e-12));
}

TEST_CASE("cut graph: 1, 2 and 7 threads give the same bits") {
  const Mesh mesh =
      shapes::joined(plate_with_tunnels(3, 0.2), shapes::joined(shapes::torus(20), shapes::cube(1)));
  const Opened one = open(mesh, {}, {}, 1);
  for (int threads : {2, 7}) {
    const Opened many = open(mesh, {}, {}, threads);
    CHECK(many.graph.corner == one.graph.corner);
    CHECK(many.graph.length == one.graph.length);
  }
}

TEST_CASE("cut graph: its length follows scale and motion and does not depend on numbering") {
  for (const Mesh& mesh :
       {plate_with_tunnels(2, 0.2), blocks(
                                        5, [](Index, Index, Index) { return true; }, 0.2)}) {
    const double length = open(mesh).graph.length;
    CHECK(open(shapes::scaled(mesh, 1e3)).graph.length == doctest::Approx(1e3 * length).epsilon(1e-9));
    CHECK(open(shapes::rigid_motion(mesh, 4)).graph.length == doctest::Approx(length).epsilon(1e-9));
    for (const std::uint64_t seed : {1, 2, 3}) {
      std::vector<Index> new_of_old;
      const Opened o = open(shapes::relabelled(mesh, seed, new_of_old));
      CHECK(o.graph.length == doctest::Approx(length).epsilon(1e-9));
    }
  }
}
