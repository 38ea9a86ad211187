#include "engine/prepare/repair.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

using namespace planish;

namespace {

/// A flat n x n grid of squares, two triangles each: vertex (i, j) is j * (n + 1) + i at (i, j, 0).
Mesh grid(Index n) {
  Mesh mesh;
  for (Index j = 0; j <= n; ++j) {
    for (Index i = 0; i <= n; ++i) mesh.position.push_back({1.0 * i, 1.0 * j, 0});
  }
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      for (Index v : {a, b, c, a, c, d}) mesh.corner_vertex.push_back(v);
    }
  }
  return mesh;
}

void add_triangle(Mesh& mesh, Index a, Index b, Index c) {
  mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, c});
}

void turn(Mesh& mesh, Index t) { std::swap(mesh.corner_vertex[3 * t + 1], mesh.corner_vertex[3 * t + 2]); }

/// Every triangle with three vertices of its own.
Mesh unwelded(const Mesh& welded) {
  Mesh mesh;
  for (Index c = 0; c < static_cast<Index>(welded.corner_vertex.size()); ++c) {
    mesh.position.push_back(welded.position[welded.corner_vertex[c]]);
    mesh.corner_vertex.push_back(c);
  }
  return mesh;
}

Repair repaired(const Mesh& mesh) {
  auto repair_of = repair(mesh);
  REQUIRE(repair_of.has_value());
  return *std::move(repair_of);
}

/// Count of a kind of mending, 0 where there is none.
Offset count_of(const Repair& repair_of, const std::string& what) {
  for (const Mending& mending : repair_of.mendings) {
    if (mending.what.find(what) != std::string::npos) return mending.count;
  }
  return 0;
}

std::vector<Index> ids_of(const Repair& repair_of, const std::string& what) {
  for (const Mending& mending : repair_of.mendings) {
    if (mending.what.find(what) != std::string::npos) return mending.ids;
  }
  return {};
}

Index num_referenced(const Mesh& mesh) {
  std::vector<Index> used = mesh.corner_vertex;
  std::sort(used.begin(), used.end());
  return static_cast<Index>(std::unique(used.begin(), used.end()) - used.begin());
}

struct Edges {
  Index open = 0, crowded = 0, disagreeing = 0, all = 0, loops = 0;
};

Edges edges_of(const Mesh& mesh) {
  std::map<std::pair<Index, Index>, std::vector<Index>> sides;
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    const Index v = mesh.corner_vertex[c], w = mesh.corner_vertex[next_corner(c)];
    sides[{std::min(v, w), std::max(v, w)}].push_back(v);
  }
  Edges edges;
  std::map<Index, Index> next;  // along open edges, either way
  std::vector<Index> group(mesh.position.size());
  for (Index v = 0; v < mesh.num_vertices(); ++v) group[v] = v;
  const auto root = [&](Index v) {
    while (group[v] != v) v = group[v];
    return v;
  };
  for (const auto& [edge, starts] : sides) {
    ++edges.all;
    edges.crowded += starts.size() > 2;
    edges.disagreeing += starts.size() == 2 && starts[0] == starts[1];
    if (starts.size() != 1) continue;
    ++edges.open;
    next[edge.first] = next[edge.second] = 1;
    group[root(edge.first)] = root(edge.second);
  }
  for (const auto& [v, one] : next) edges.loops += root(v) == v ? one : 0;
  return edges;
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const Vec3 a = mesh.position[mesh.corner_vertex[3 * t]];
    const Vec3 b = mesh.position[mesh.corner_vertex[3 * t + 1]],
               c = mesh.position[mesh.corner_vertex[3 * t + 2]];
    sum += norm(cross(b - a, c - a)) / 2;
  }
  return sum;
}

double smallest_area(const Mesh& mesh) {
  double smallest = kInfinity;
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const Vec3 a = mesh.position[mesh.corner_vertex[3 * t]];
    const Vec3 b = mesh.position[mesh.corner_vertex[3 * t + 1]],
               c = mesh.position[mesh.corner_vertex[3 * t + 2]];
    smallest = std::min(smallest, norm(cross(b - a, c - a)) / 2);
  }
  return smallest;
}

/// What every repair keeps: originals in place, copies where their originals are.
void check_origins(const Mesh& input, const Repair& repair_of) {
  REQUIRE(repair_of.vertex_origin.size() == repair_of.mesh.position.size());
  REQUIRE(repair_of.triangle_origin.size() == static_cast<std::size_t>(repair_of.mesh.num_triangles()));
  REQUIRE(repair_of.mesh.num_vertices() >= input.num_vertices());
  for (Index v = 0; v < repair_of.mesh.num_vertices(); ++v) {
    if (v < input.num_vertices()) CHECK(repair_of.vertex_origin[v] == v);
    CHECK(repair_of.mesh.position[v] == input.position[repair_of.vertex_origin[v]]);
  }
  CHECK(std::is_sorted(repair_of.triangle_origin.begin(), repair_of.triangle_origin.end()));
}

}  // namespace

TEST_CASE("repair: a mesh that needs nothing comes back as it was") {
  Mesh mesh = grid(4);
  mesh.position.push_back({9, 9, 9});  // unreferenced
  mesh.position.push_back({1, 1, 0});  // unreferenced, at the position of another
  const Repair same = repaired(mesh);
  CHECK(same.mendings.empty());
  CHECK(same.mesh.position == mesh.position);
  CHECK(same.mesh.corner_vertex == mesh.corner_vertex);
  check_origins(mesh, same);
}

TEST_CASE("repair: two sheets that lie on one another, or touch in a point, stay two sheets") {
  Mesh mesh = grid(3);
  const Index n = mesh.num_vertices();
  const Mesh copy = mesh;
  for (const Vec3& p : copy.position) mesh.position.push_back(p);
  for (Index v : copy.corner_vertex) mesh.corner_vertex.push_back(n + v);
  CHECK(repaired(mesh).mendings.empty());
  Mesh touching = copy;
  for (const Vec3& p : copy.position) touching.position.push_back(p + Vec3{3, 3, 0});
  for (Index v : copy.corner_vertex) touching.corner_vertex.push_back(n + v);
  CHECK(repaired(touching).mendings.empty());
}

TEST_CASE("repair: triangles with vertices of their own are welded along their edges") {
  const Mesh welded = grid(5), mesh = unwelded(welded);
  const Repair whole = repaired(mesh);
  CHECK(num_referenced(whole.mesh) == welded.num_vertices());
  CHECK(edges_of(whole.mesh).open == 20);
  CHECK(area_of(whole.mesh) == doctest::Approx(25));
  CHECK(count_of(whole, "merged") == mesh.num_vertices() - welded.num_vertices());
  check_origins(mesh, whole);
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    CHECK(mesh.position[whole.mesh.corner_vertex[c]] == mesh.position[mesh.corner_vertex[c]]);
    CHECK(whole.mesh.corner_vertex[c] <= c);  // the first of the merged stands for them
  }
}

TEST_CASE("repair: a crack closes, and signed zeros are one position") {
  Mesh mesh = grid(4);
  // The middle row of vertices twice: triangles above j = 2 take the copies.
  const Index first = mesh.num_vertices();
  for (Index i = 0; i <= 4; ++i) mesh.position.push_back({1.0 * i, 2, -0.0});
  for (Index c = 3 * 16; c < 3 * 32; ++c) {
    Index& v = mesh.corner_vertex[c];
    if (v >= 10 && v < 15) v = first + v - 10;
  }
  REQUIRE(edges_of(mesh).open == 24);
  const Repair closed = repaired(mesh);
  CHECK(edges_of(closed.mesh).open == 16);
  CHECK(ids_of(closed, "merged") == std::vector<Index>{25, 26, 27, 28, 29});
}

TEST_CASE(
    "repair: vertices stay apart where merging would join a third triangle to an edge, and it says so") {
  Mesh mesh = unwelded(grid(4));
  const Index n = mesh.num_vertices();
  for (Vec3 p : {Vec3{1, 2, 0}, Vec3{2, 2, 0}, Vec3{1.5, 2, 1}}) mesh.position.push_back(p);
  add_triangle(mesh, n, n + 1, n + 2);  // a fin on an inner edge
  const Repair whole = repaired(mesh);
  CHECK(edges_of(whole.mesh).crowded == 0);
  CHECK(num_referenced(whole.mesh) == 25 + 3);
  CHECK(ids_of(whole, "left apart") == std::vector<Index>{n, n + 1});
}

TEST_CASE("repair: triangles that name a vertex twice, and copies of triangles, are dropped") {
  Mesh mesh = grid(2);
  add_triangle(mesh, 0, 0, 1);
  add_triangle(mesh, 1, 4, 0);  // triangle 0 once more
  const Repair mended = repaired(mesh);
  CHECK(ids_of(mended, "names a vertex twice").empty());
  CHECK(ids_of(mended, "name a vertex twice") == std::vector<Index>{8});
  CHECK(ids_of(mended, "copies") == std::vector<Index>{9});
  CHECK(mended.mesh.corner_vertex == grid(2).corner_vertex);
  check_origins(mesh, mended);
}

TEST_CASE("repair: a flap of two triangles back to back goes altogether") {
  Mesh mesh = grid(2);
  mesh.position.push_back({0.5, 0.5, 1});
  add_triangle(mesh, 0, 4, 9);
  add_triangle(mesh, 4, 0, 9);
  const Repair mended = repaired(mesh);
  CHECK(mended.mesh.corner_vertex == grid(2).corner_vertex);
  CHECK(count_of(mended, "copies") == 1);
  CHECK(count_of(mended, "flaps") == 1);
  // A doubled triangle of a larger fin is no flap.
  mesh.position.push_back({1, 1, 1});
  add_triangle(mesh, 9, 4, 10);
  CHECK(count_of(repaired(mesh), "copies") == 1);
  CHECK(count_of(repaired(mesh), "flaps") == 0);
  Mesh fin = grid(2);  // one side only: a third triangle on an edge, not ours to judge
  fin.position.push_back({0.5, 0.5, 1});
  add_triangle(fin, 0, 4, 9);
  CHECK(repaired(fin).mendings.empty());
}

TEST_CASE("repair: the smaller part is turned, in every component by itself") {
  Mesh mesh = grid(4);
  for (Index t : {5, 6, 30}) turn(mesh, t);
  const Repair few = repaired(mesh);
  CHECK(ids_of(few, "turned") == std::vector<Index>{5, 6, 30});
  CHECK(few.mesh.corner_vertex == grid(4).corner_vertex);
  Mesh many = grid(4);
  for (Index t = 0; t < many.num_triangles(); ++t) {
    if (t != 7) turn(many, t);
  }
  CHECK(ids_of(repaired(many), "turned") == std::vector<Index>{7});
  Mesh first = grid(4);
  turn(first, 0);
  CHECK(ids_of(repaired(first), "turned") == std::vector<Index>{0});
  // A second component, all of it the other way round: nothing to say about it.
  const Mesh other = grid(4);
  for (const Vec3& p : other.position) mesh.position.push_back(p + Vec3{10, 0, 0});
  for (Index v : other.corner_vertex) mesh.corner_vertex.push_back(25 + v);
  for (Index t = 32; t < 64; ++t) turn(mesh, t);
  CHECK(ids_of(repaired(mesh), "turned") == std::vector<Index>{5, 6, 30});
  CHECK(edges_of(repaired(mesh).mesh).disagreeing == 0);
}

TEST_CASE("repair: a Moebius strip is left as it is") {
  Mesh mesh;
  for (Index i = 0; i < 5; ++i) {
    const double a = 2 * kPi * i / 5;
    for (double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(a / 2);
      mesh.position.push_back({r * std::cos(a), r * std::sin(a), side * std::sin(a / 2)});
    }
  }
  for (Index i = 0; i < 5; ++i) {
    const Index a = 2 * i, b = 2 * i + 1, c = i < 4 ? a + 2 : 1, d = i < 4 ? b + 2 : 0;
    add_triangle(mesh, a, c, b);
    add_triangle(mesh, b, c, d);
  }
  REQUIRE(edges_of(mesh).disagreeing > 0);
  const Repair same = repaired(mesh);
  CHECK(same.mendings.empty());
  CHECK(same.mesh.corner_vertex == mesh.corner_vertex);
}

TEST_CASE("repair: fans that meet in a vertex only get one each") {
  Mesh mesh = grid(2);
  for (Vec3 p : {Vec3{3, 2, 0}, Vec3{3, 3, 0}, Vec3{2, 3, 1}, Vec3{3, 3, 1}}) mesh.position.push_back(p);
  add_triangle(mesh, 8, 9, 10);
  add_triangle(mesh, 8, 11, 12);
  const Repair split = repaired(mesh);
  CHECK(ids_of(split, "split") == std::vector<Index>{8});
  REQUIRE(split.mesh.num_vertices() == 15);
  CHECK(split.vertex_origin[13] == 8);
  CHECK(split.vertex_origin[14] == 8);
  CHECK(split.mesh.corner_vertex[3 * 7 + 1] == 8);  // the first fan keeps the vertex
  CHECK(split.mesh.corner_vertex[3 * 8] == 13);
  CHECK(split.mesh.corner_vertex[3 * 9] == 14);
  check_origins(mesh, split);
}

TEST_CASE("repair: an edge of three triangles is not torn open") {
  Mesh mesh = grid(2);
  mesh.position.push_back({0.5, 0.5, 1});
  add_triangle(mesh, 0, 4, 9);
  const Repair same = repaired(mesh);
  CHECK(same.mesh.num_vertices() == 10);
  CHECK(edges_of(same.mesh).crowded == 1);
}

TEST_CASE("repair: an edge without length is closed") {
  Mesh mesh = grid(4);
  mesh.position[12] = mesh.position[13];
  const Repair mended = repaired(mesh);
  CHECK(ids_of(mended, "merged") == std::vector<Index>{13});
  CHECK(count_of(mended, "name a vertex twice") == 2);
  CHECK(smallest_area(mended.mesh) > 0.1);
  CHECK(edges_of(mended.mesh).open == 16);
  CHECK(num_referenced(mended.mesh) - edges_of(mended.mesh).all + mended.mesh.num_triangles() == 1);
}

TEST_CASE("repair: size and place do not make a triangle flat, thinness does") {
  for (double scale : {1e-9, 1.0, 1e9}) {
    Mesh mesh = grid(3);
    for (Vec3& p : mesh.position) p = scale * p;
    CHECK(repaired(mesh).mendings.empty());
    for (Vec3& p : mesh.position) p = p + scale * Vec3{4.5e6, 5.2e6, 300};
    CHECK(repaired(mesh).mendings.empty());
  }
}

TEST_CASE("repair: a thin triangle that the coordinates can still tell is left") {
  Mesh mesh;
  mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5 + 1e-14, 0.5, 0}};
  for (Index v : {0, 1, 4, 1, 2, 4, 0, 4, 2, 0, 2, 3}) mesh.corner_vertex.push_back(v);
  CHECK(repaired(mesh).mendings.empty());
}

TEST_CASE("repair: coordinates that are no numbers are left for diagnose()") {
  Mesh mesh = grid(2);
  mesh.position[4].y = std::nan("");
  mesh.position[0].x = kInfinity;
  const Repair same = repaired(mesh);
  CHECK(same.mendings.empty());
  CHECK(same.mesh.corner_vertex == mesh.corner_vertex);
}

TEST_CASE("repair: attributes, uv and statements follow their elements") {
  Mesh mesh = grid(1);
  mesh.position.push_back({2, 2, 0});
  mesh.position.push_back({3, 2, 0});
  add_triangle(mesh, 0, 0, 1);  // dropped
  add_triangle(mesh, 3, 5, 4);  // a fan of its own at vertex 3
  add_triangle(mesh, 3, 4, 4);  // dropped
  turn(mesh, 1);
  const auto column = [](const std::string& name, Index n) {
    Attribute a{name, Scalar::UInt16, {}};
    for (Index i = 0; i < n; ++i) a.values.insert(a.values.end(), {std::byte(i), std::byte(100 + i)});
    return a;
  };
  mesh.vertex_attributes = {column("colour", 6)};
  mesh.triangle_attributes = {column("part", 5)};
  mesh.statements = {{0, "g a"}, {2, "g b"}, {4, "g c"}};
  mesh.uv_sets.push_back({"st", {}, true});
  for (Index v : mesh.corner_vertex) mesh.uv_sets[0].corner_uv.push_back({1.0 * v, -1.0 * v});
  const Repair mended = repaired(mesh);
  REQUIRE(mended.triangle_origin == std::vector<Index>{0, 1, 3});
  REQUIRE(mended.vertex_origin == std::vector<Index>{0, 1, 2, 3, 4, 5, 3});
  const std::vector<std::byte>& colour = mended.mesh.vertex_attributes[0].values;
  REQUIRE(colour.size() == 14);
  CHECK(colour[12] == std::byte(3));
  CHECK(colour[13] == std::byte(103));
  const std::vector<std::byte>& part = mended.mesh.triangle_attributes[0].values;
  REQUIRE(part.size() == 6);
  CHECK(part[4] == std::byte(3));
  REQUIRE(mended.mesh.statements.size() == 3);
  CHECK(mended.mesh.statements[0].triangle == 0);
  CHECK(mended.mesh.statements[1].triangle == 2);  // now the triangle that was the fourth
  CHECK(mended.mesh.statements[2].triangle == 3);
  for (Index c = 0; c < 9; ++c) {
    CHECK(mended.mesh.uv_sets[0].corner_uv[c].x == mended.vertex_origin[mended.mesh.corner_vertex[c]]);
  }
  CHECK(mended.mesh.uv_sets[0].per_vertex);
}

TEST_CASE("repair: vertices merged with different uv no longer have one uv each") {
  Mesh mesh = unwelded(grid(1));
  mesh.uv_sets.push_back({"st", {}, true});
  for (Index c = 0; c < 6; ++c) mesh.uv_sets[0].corner_uv.push_back({1.0 * c, 0});
  CHECK_FALSE(repaired(mesh).mesh.uv_sets[0].per_vertex);
}

TEST_CASE("repair: a second repair finds nothing to do") {
  Mesh mesh = unwelded(grid(4));
  for (Index t : {3, 8, 9}) turn(mesh, t);
  add_triangle(mesh, 5, 5, 1);
  const Repair once = repaired(mesh);
  CHECK(once.mendings.size() >= 3);
  CHECK(repaired(once.mesh).mendings.empty());
}

TEST_CASE("repair: a vertex that does not exist is named with its triangle") {
  Mesh mesh = grid(1);
  mesh.corner_vertex[4] = 77;
  const auto failed = repair(mesh);
  REQUIRE_FALSE(failed.has_value());
  CHECK(failed.error().code == ErrorCode::IndexOutOfRange);
  CHECK(failed.error().ids == std::vector<Index>{1});
}

TEST_CASE("repair: coordinates too large or too small to be scaled make no triangle flat") {
  for (double scale : {1e-200, 1e200, 0.9e308}) {
    CAPTURE(scale);
    Mesh mesh = grid(2);  // 2 by 2: the last is wider than doubles can hold
    for (Vec3& p : mesh.position) p = scale * (p - Vec3{1, 1, 0});
    const Repair same = repaired(mesh);
    CHECK(same.mendings.empty());
    CHECK(same.mesh.corner_vertex == mesh.corner_vertex);
  }
}

#ifdef PLANISH_WITH_CGAL_GPL

TEST_CASE("repair: an edge without length stays where closing it would pinch a tube") {
  Mesh mesh;  // triangular tube of two storeys, its waist an edge without length
  for (double z : {-1.0, 0.0, 1.0}) {
    for (Vec2 p : {Vec2{0, 0}, Vec2{z == 0 ? 0.0 : 1.0, 0}, Vec2{0, 1}})
      mesh.position.push_back({p.x, p.y, z});
  }
  for (Index ring : {0, 3}) {
    for (Index i = 0; i < 3; ++i) {
      const Index a = ring + i, b = ring + (i + 1) % 3;
      add_triangle(mesh, a, b, b + 3);
      add_triangle(mesh, a, b + 3, a + 3);
    }
  }
  const Repair same = repaired(mesh);
  CHECK(same.mesh.corner_vertex == mesh.corner_vertex);
  CHECK(ids_of(same, "left apart") == std::vector<Index>{4});
}

TEST_CASE("repair: an edge shorter than the coordinates can tell is closed") {
  Mesh mesh = grid(4);
  mesh.position[12] = mesh.position[13] - Vec3{4e-16, 0, 0};
  REQUIRE(mesh.position[12] != mesh.position[13]);
  const Repair mended = repaired(mesh);
  CHECK(count_of(mended, "shorter than the coordinates") == 1);
  CHECK(mended.mesh.num_triangles() == 30);
  CHECK(smallest_area(mended.mesh) > 0.1);
  CHECK(edges_of(mended.mesh).open == 16);
}

TEST_CASE("repair: a cap inside is flipped away, without a hole and without loss of area") {
  // Square 0 1 2 3 with vertex 4 on its diagonal 0 2, both sides triangulated differently: 0 4 2 is a cap.
  Mesh mesh;
  mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
  for (Index v : {0, 1, 4, 1, 2, 4, 0, 4, 2, 0, 2, 3}) mesh.corner_vertex.push_back(v);
  mesh.uv_sets.push_back({"vt", {}, false});
  for (Index c = 0; c < 12; ++c) mesh.uv_sets[0].corner_uv.push_back({1.0 * c, 0.5});
  const Repair mended = repaired(mesh);
  CHECK(ids_of(mended, "flipped") == std::vector<Index>{2});
  CHECK(mended.mesh.num_triangles() == 4);
  CHECK(smallest_area(mended.mesh) > 0.2);
  CHECK(area_of(mended.mesh) == doctest::Approx(1));
  CHECK(edges_of(mended.mesh).open == 4);
  CHECK(edges_of(mended.mesh).disagreeing == 0);
  // Corners take their uv along: vertex 3 was corner 11 only, vertex 4 of the cap corner 7.
  const std::vector<Index>& corner_vertex = mended.mesh.corner_vertex;
  for (Index c = 6; c < 12; ++c) {
    const double origin = mended.mesh.uv_sets[0].corner_uv[c].x;
    CHECK(mesh.corner_vertex[static_cast<Index>(origin)] == corner_vertex[c]);
    if (corner_vertex[c] == 4) CHECK(origin == 7);
    if (corner_vertex[c] == 3) CHECK(origin == 11);
  }
}

TEST_CASE("repair: caps in a row along one edge all go") {
  Mesh mesh;
  mesh.position = {{0, 0, 0}, {4, 0, 0}, {2, 3, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {2, -3, 0}};
  for (Index v : {4, 5, 1, 3, 4, 1, 0, 3, 1, 0, 1, 2, 0, 6, 3, 3, 6, 4, 4, 6, 5, 5, 6, 1}) {
    mesh.corner_vertex.push_back(v);
  }
  REQUIRE(edges_of(mesh).open == 4);
  REQUIRE(edges_of(mesh).disagreeing == 0);
  const Repair mended = repaired(mesh);
  CHECK(smallest_area(mended.mesh) > 0.5);
  CHECK(area_of(mended.mesh) == doctest::Approx(12));
  CHECK(edges_of(mended.mesh).open == 4);
  CHECK(edges_of(mended.mesh).loops == 1);
}

TEST_CASE("repair: a cap at the border goes, and a mesh of nothing else is left without triangles") {
  Mesh mesh = grid(2);
  mesh.position.push_back({0, 0.5, 0});
  // Vertex 9 on the border edge 3 0 of triangle 0 4 3.
  mesh.corner_vertex.resize(3);
  for (Index v : {0, 4, 9, 9, 4, 3, 3, 0, 9}) mesh.corner_vertex.push_back(v);
  const Repair mended = repaired(mesh);
  CHECK(ids_of(mended, "at the border") == std::vector<Index>{3});
  CHECK(smallest_area(mended.mesh) > 0.2);
  CHECK(edges_of(mended.mesh).loops == 1);
  Mesh flat;
  flat.position = {{0, 0, 0}, {1, 0, 0}, {2.7, 0, 0}};
  flat.corner_vertex = {0, 1, 2};
  CHECK(repaired(flat).mesh.num_triangles() == 0);
  CHECK(repaired(flat).mesh.num_vertices() == 3);
}

TEST_CASE("repair: a cap whose removal would tear the surface stays") {
  // Two squares joined by a triangle without area, its long edge on the border, its apex too.
  Mesh mesh;
  mesh.position = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0.5, -1, 0}, {1.5, -1, 0}};
  for (Index v : {0, 2, 1, 0, 3, 2, 2, 4, 1}) mesh.corner_vertex.push_back(v);
  const Repair same = repaired(mesh);
  CHECK(same.mesh.num_triangles() == 3);
  CHECK(same.mendings.empty());
}

TEST_CASE("repair: triangles without area are found in huge and tiny coordinates too") {
  for (double scale : {1e-200, 1.0, 1e200}) {
    CAPTURE(scale);
    Mesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
    for (Vec3& p : mesh.position) p = scale * p;
    for (Index v : {0, 1, 4, 1, 2, 4, 0, 4, 2, 0, 2, 3}) mesh.corner_vertex.push_back(v);
    CHECK(ids_of(repaired(mesh), "flipped") == std::vector<Index>{2});
  }
}

#else

TEST_CASE("repair: without CGAL's GPL packages triangles without area are refused, with their ids") {
  Mesh mesh = unwelded(grid(2));
  const Index n = mesh.num_vertices();
  mesh.corner_vertex.insert(mesh.corner_vertex.begin(), {0, 0, 1});  // dropped: ids are those of the input
  for (Vec3 p : {Vec3{9, 0, 0}, Vec3{10, 0, 0}, Vec3{11.7, 0, 0}}) mesh.position.push_back(p);
  add_triangle(mesh, n, n + 1, n + 2);
  const auto failed = repair(mesh);
  REQUIRE_FALSE(failed.has_value());
  CHECK(failed.error().code == ErrorCode::NotBuilt);
  CHECK(failed.error().element == ElementKind::Triangle);
  CHECK(failed.error().ids == std::vector<Index>{9});
  CHECK(failed.error().count == 1);
}

TEST_CASE("repair: without CGAL's GPL packages components it would not touch are left to diagnose()") {
  Mesh mesh = grid(2);
  for (Vec3 p : {Vec3{1, 1, 1}, Vec3{1, 1, 2}}) mesh.position.push_back(p);
  add_triangle(mesh, 0, 4, 9);   // a fin: the component is not manifold
  add_triangle(mesh, 9, 4, 10);  // and has no area there
  const Repair same = repaired(mesh);
  CHECK(same.mesh.corner_vertex == mesh.corner_vertex);
}

#endif
