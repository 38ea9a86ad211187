#include "engine/features/plane_cut.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/features/nearest.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

struct Model {
  explicit Model(Mesh m) : mesh(std::move(m)), topology(build_topology(Exec(1), mesh.surface())) {}
  Mesh mesh;
  Topology topology;

  Result<SurfaceCurve> cut(const PlaneCutSource& source, int threads = 1) const {
    return plane_cut(Exec(threads), mesh.surface(), topology, "centre", source);
  }

  Vec3 corner(Index t, Index i) const { return mesh.position[mesh.corner_vertex[3 * t + i]]; }
  Vec3 position(const SurfacePoint& p) const {
    const Vec3 b = p.barycentric;
    return b.x * corner(p.triangle, 0) + b.y * corner(p.triangle, 1) + b.z * corner(p.triangle, 2);
  }
  /// Vertices with weight, ascending.
  std::vector<Index> support(const SurfacePoint& p) const {
    const double b[3] = {p.barycentric.x, p.barycentric.y, p.barycentric.z};
    std::vector<Index> result;
    for (Index i = 0; i < 3; ++i) {
      if (b[i] != 0) result.push_back(mesh.corner_vertex[3 * p.triangle + i]);
    }
    std::sort(result.begin(), result.end());
    return result;
  }
  bool triangle_holds(Index t, const std::vector<Index>& vertices) const {
    const auto first = mesh.corner_vertex.begin() + 3 * t;
    return std::all_of(vertices.begin(), vertices.end(),
                       [&](Index v) { return std::find(first, first + 3, v) != first + 3; });
  }
};

/// What holds for every curve: weights sum to 1, points lie on edges and on the plane, each segment in the
/// triangle of its first point, no point comes twice, open ends lie on the boundary.
void check_curve(const Model& model, const PlaneCutSource& source, const SurfaceCurve& curve) {
  REQUIRE(curve.at.size() == curve.position.size());
  REQUIRE(curve.at.size() >= (curve.closed ? 3 : 2));
  const Vec3 unit_normal = 1 / norm(source.normal) * source.normal;
  std::vector<std::vector<Index>> supports;
  for (std::size_t i = 0; i < curve.at.size(); ++i) {
    const Vec3 b = curve.at[i].barycentric;
    CHECK(std::min({b.x, b.y, b.z}) >= 0);
    CHECK(b.x + b.y + b.z == doctest::Approx(1).epsilon(1e-15));
    CHECK(norm(model.position(curve.at[i]) - curve.position[i]) < 1e-14);
    CHECK(std::abs(dot(unit_normal, curve.position[i] - source.point)) < 1e-14);
    supports.push_back(model.support(curve.at[i]));
    CHECK(supports.back().size() <= 2);
  }
  for (std::size_t i = 0; i + (curve.closed ? 0 : 1) < curve.at.size(); ++i)
    CHECK(model.triangle_holds(curve.at[i].triangle, supports[(i + 1) % supports.size()]));
  std::sort(supports.begin(), supports.end());
  CHECK(std::adjacent_find(supports.begin(), supports.end()) == supports.end());
}

double length(const SurfaceCurve& curve) {
  double sum = 0;
  for (std::size_t i = curve.closed ? 0 : 1; i < curve.position.size(); ++i)
    sum += norm(curve.position[i] - (i == 0 ? curve.position.back() : curve.position[i - 1]));
  return sum;
}

double distance(const SurfaceCurve& curve, Vec3 p) {
  double least = kInfinity;
  for (std::size_t i = curve.closed ? 0 : 1; i < curve.position.size(); ++i) {
    const Vec3 previous = i == 0 ? curve.position.back() : curve.position[i - 1];
    least = std::min(least, squared_distance_to_segment(p, previous, curve.position[i]));
  }
  return std::sqrt(least);
}

/// Distance of p to the plane's cuts through all triangles, one by one.
double least_distance(const Model& model, const PlaneCutSource& source, Vec3 p) {
  double least = kInfinity;
  for (Index t = 0; t < model.mesh.num_triangles(); ++t) {
    std::vector<Vec3> ends;
    for (Index i = 0; i < 3; ++i) {
      const Vec3 a = model.corner(t, i), b = model.corner(t, (i + 1) % 3);
      const double ha = dot(source.normal, a - source.point), hb = dot(source.normal, b - source.point);
      if ((ha < 0) != (hb < 0)) ends.push_back(a + ha / (ha - hb) * (b - a));
    }
    if (ends.size() == 2) least = std::min(least, squared_distance_to_segment(p, ends[0], ends[1]));
  }
  return std::sqrt(least);
}

/// n-gon of radius 1 around the z axis, `rows` quads high from z = 0 to 1; open at both ends.
Mesh tube(Index n, Index rows) {
  Mesh mesh;
  for (Index j = 0; j <= rows; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Vec2 p = unit(2 * kPi * i / n);
      mesh.position.push_back({p.x, p.y, static_cast<double>(j) / rows});
    }
  }
  for (Index j = 0; j < rows; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = j * n + i, b = j * n + (i + 1) % n, c = a + n, d = b + n;
      mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, d, a, d, c});
    }
  }
  return mesh;
}

double roof(double x, double) { return -std::abs(x); }
double hip_roof(double x, double y) { return -std::max(std::abs(x), std::abs(y) - 0.5); }
double hip_valley(double x, double y) { return -hip_roof(x, y); }
double peak(double x, double y) { return -std::abs(x) - std::abs(y); }
double saddle(double x, double y) { return x * y; }
double table(double x, double y) { return -std::max(0.0, std::max(std::abs(x), std::abs(y)) - 0.5); }

const PlaneCutSource kGround{{0, 0, 0}, {0, 0, 1}, {0, 0, 0}};

}  // namespace

TEST_CASE("plane cut: a tube across its axis is cut in its polygon, at rows of vertices too") {
  const Index n = 60;
  const Model model(tube(n, 4));
  for (const double z : {0.3, 0.5, 0.61}) {
    const PlaneCutSource source{{5, 7, z}, {0, 0, 3}, {2, 0, z}};
    const SurfaceCurve curve = model.cut(source).value();
    check_curve(model, source, curve);
    CHECK(curve.closed);
    CHECK(length(curve) == doctest::Approx(2 * n * std::sin(kPi / n)).epsilon(1e-13));
    CHECK(curve.position.size() == (z == 0.5 ? 60 : 120));
    CHECK(norm(curve.position.front() - Vec3{1, 0, z}) < 0.06);
  }
}

TEST_CASE("plane cut: a tube along its axis is cut in two straight pieces, the nearer one is taken") {
  const Model model(tube(60, 4));
  for (const double side : {-1.0, 1.0}) {
    const PlaneCutSource source{{0, 0, 0}, {0, 1, 0}, {side, 0.2, 0.5}};
    const SurfaceCurve curve = model.cut(source).value();
    check_curve(model, source, curve);
    CHECK(!curve.closed);
    CHECK(curve.position.size() == 5);
    CHECK(length(curve) == doctest::Approx(1).epsilon(1e-14));
    CHECK(curve.position.front().x == doctest::Approx(side).epsilon(1e-14));
  }
}

TEST_CASE("plane cut: the sides of the tube bound the curve with the normal's side on the left") {
  const Model model(tube(60, 4));  // front outside: left of a step upwards is -angle
  const SurfaceCurve curve = model.cut({{0, 0, 0}, {0, 1, 0}, {1, 0, 0.5}}).value();
  CHECK(curve.position.front().z == 1);
  const SurfaceCurve turned = model.cut({{0, 0, 0}, {0, -1, 0}, {1, 0, 0.5}}).value();
  CHECK(turned.position.front().z == 0);
}

TEST_CASE("plane cut: a regular grid is cut along edges, diagonals and through cells") {
  const Model model(shapes::height_field(9, shapes::flat, 0));
  const auto points = [&](Vec3 normal, Vec3 point) {
    const PlaneCutSource source{point, normal, {0, 0, 0}};
    const SurfaceCurve curve = model.cut(source).value();
    check_curve(model, source, curve);
    CHECK(!curve.closed);
    return curve;
  };
  CHECK(points({1, 0, 0}, {0.25, 0, 0}).position.size() == 9);
  CHECK(points({1, 0, 0}, {0.3, 0, 0}).position.size() == 17);
  CHECK(points({0, -1, 0}, {0, -1, 0}).position.size() == 9);  // the boundary itself, from either side
  CHECK(points({0, 1, 0}, {0, -1, 0}).position.size() == 9);
  const SurfaceCurve diagonal = points({1, -1, 0}, {0, 0, 0});
  CHECK(length(diagonal) == doctest::Approx(2 * std::sqrt(2)).epsilon(1e-14));
  CHECK(diagonal.position.size() == 9);
  CHECK(length(points({1, -3, 0}, {0, 0, 0})) == doctest::Approx(2 * std::sqrt(1 + 1 / 9.0)).epsilon(1e-14));
}

TEST_CASE("plane cut: random planes give the piece nearest to the point, by brute force") {
  shapes::Random random(11);
  const auto coordinate = [&] { return 2 * random.uniform() - 1; };
  for (const Mesh& mesh : {shapes::wavy_disk(800), shapes::torus(14), shapes::frame(15, saddle)}) {
    const Model model(mesh);
    int cuts = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const PlaneCutSource source{{coordinate(), coordinate(), 0.3 * coordinate()},
                                  {coordinate(), coordinate(), coordinate()},
                                  {coordinate(), coordinate(), coordinate()}};
      const auto curve = model.cut(source);
      const double expected = least_distance(model, source, source.near);
      REQUIRE(curve.has_value() == (expected < kInfinity));
      if (!curve) continue;
      ++cuts;
      check_curve(model, source, *curve);
      CHECK(distance(*curve, source.near) == doctest::Approx(expected).epsilon(1e-12));
    }
    CHECK(cuts > 30);
  }
}

TEST_CASE("plane cut: random planes through vertices of a regular grid give simple curves") {
  const Model model(shapes::height_field(13, saddle, 0));
  shapes::Random random(12);
  const auto vertex = [&] { return model.mesh.position[random.bits() % model.mesh.position.size()]; };
  int cuts = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Vec3 a = vertex(), b = vertex(), c = vertex();
    const PlaneCutSource source{a, cross(b - a, c - a), b};
    if (norm(source.normal) < 1e-9) continue;
    const auto curve = model.cut(source);
    if (!curve) continue;  // touched in a corner only
    ++cuts;
    check_curve(model, source, *curve);
  }
  CHECK(cuts > 300);
}

TEST_CASE("plane cut: a torus through its equators has two circles") {
  const Index n = 24;
  const Model model(shapes::torus(n));
  for (const double radius : {3.0, 1.0}) {
    const PlaneCutSource source{{0, 0, 0}, {0, 0, 1}, {radius, 0, 0.1}};
    const SurfaceCurve curve = model.cut(source).value();
    check_curve(model, source, curve);
    CHECK(curve.closed);
    CHECK(curve.position.size() == n);
    CHECK(length(curve) == doctest::Approx(2 * n * radius * std::sin(kPi / n)).epsilon(1e-13));
  }
}

TEST_CASE("plane cut: ridges and valleys that the plane only touches are curves, from either side") {
  for (const double side : {1.0, -1.0}) {
    PlaneCutSource source = kGround;
    source.normal.z = side;
    for (auto* height : {roof, hip_roof, hip_valley}) {
      const Model model(shapes::height_field(9, height, 0));
      const SurfaceCurve curve = model.cut(source).value();
      check_curve(model, source, curve);
      CHECK(!curve.closed);
      CHECK(curve.position.size() == (height == roof ? 9 : 5));
      for (const Vec3& p : curve.position) CHECK(p.x == 0);
    }
  }
}

TEST_CASE("plane cut: where triangles lie in the plane the curve is their border") {
  for (const double side : {1.0, -1.0}) {
    PlaneCutSource source = kGround;
    source.normal.z = side;
    const Model model(shapes::height_field(9, table, 0)), cube(shapes::cube(2));
    const SurfaceCurve border = model.cut(source).value(), square = cube.cut(source).value();
    check_curve(model, source, border);
    check_curve(cube, source, square);
    CHECK(border.closed);
    CHECK(length(border) == doctest::Approx(4));
    CHECK(square.closed);
    CHECK(square.position.size() == 4);
    CHECK(length(square) == doctest::Approx(8));
  }
}

TEST_CASE("plane cut: lines that cross in a saddle are simple curves through it or up to it") {
  const Model model(shapes::height_field(9, saddle, 0));
  PlaneCutSource source = kGround;
  source.near = {0.9, 0.1, 0};
  const SurfaceCurve curve = model.cut(source).value();
  check_curve(model, source, curve);
  CHECK(curve.position.size() == 9);
}

TEST_CASE("plane cut: a plane that misses, touches in a point or holds the whole surface is refused") {
  const auto words = [](const Mesh& mesh, const PlaneCutSource& source) {
    const auto result = Model(mesh).cut(source);
    REQUIRE(!result);
    CHECK(result.error().code == ErrorCode::FeatureBroken);
    return result.error().what;
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  CHECK(has(words(shapes::cube(1), {{0, 0, 3.5}, {0, 0, -2}, {0, 0, 0}}), "misses the surface by 2.5"));
  CHECK(has(words(shapes::height_field(9, peak, 0), kGround), "touches"));
  CHECK(has(words(shapes::height_field(9, shapes::flat), kGround), "whole surface lies in the plane"));
  CHECK(has(words(shapes::cube(1), {{0, 0, 0.5}, {0, 0, 0}, {0, 0, 0}}), "is zero"));
  CHECK(has(words(shapes::cube(1), {{0, kInfinity, 0}, {0, 0, 1}, {0, 0, 0}}), "\"point\""));
  CHECK(has(words(shapes::cube(1), {{0, 0, 0}, {0, 0, std::nan("")}, {0, 0, 0}}), "\"normal\""));
  CHECK(has(words(shapes::cube(1), {{0, 0, 0}, {0, 0, 1}, {std::nan(""), 0, 0}}), "\"near\""));
}

TEST_CASE("plane cut: vertices within rounding of a tilted plane are on it") {
  const Mesh grid = shapes::height_field(17, shapes::flat, 0);
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const Model model(shapes::rigid_motion(grid, seed));
    const Vec3 a = model.mesh.position[8 * 17], b = model.mesh.position[8 * 17 + 16],
               c = model.mesh.position[16 * 17 + 8];
    const PlaneCutSource source{a, c - 0.5 * (a + b), b};
    CHECK(model.cut(source).value().position.size() == 17);
  }
}

TEST_CASE("plane cut: unused vertices, numbering, size of the normal and threads do not matter") {
  Mesh mesh = shapes::wavy_disk(3000);
  const PlaneCutSource source{{0.1, 0.05, 0}, {0.3, 1, 0.2}, {0.2, 0.1, 0}};
  const SurfaceCurve curve = Model(mesh).cut(source).value();
  std::vector<Index> new_of_old;
  CHECK(Model(shapes::relabelled(mesh, 9, new_of_old)).cut(source).value().position == curve.position);
  for (const int threads : {2, 7}) CHECK(Model(mesh).cut(source, threads).value().position == curve.position);
  for (const double factor : {0x1p-600, 0x1p600}) {
    PlaneCutSource other = source;
    other.normal = factor * source.normal;
    CHECK(Model(mesh).cut(other).value().position == curve.position);
  }
  mesh.position.push_back({std::nan(""), 1e300, 0});
  CHECK(Model(mesh).cut(source).value().position == curve.position);
}
