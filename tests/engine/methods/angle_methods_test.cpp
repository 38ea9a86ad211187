// abf and yamabe as a caller of flatten has them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <functional>

#include "engine/flatten.hpp"
#include "tests/engine/methods/method_shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

constexpr Index kSide = 15;  // vertices along a side of the square

double hill(double x, double y) { return 0.4 * std::exp(-2 * (x * x + y * y)) + 0.15 * x * y; }
double spire(double x, double y) { return 4 * std::exp(-20 * (x * x + y * y)); }
double spire_aside(double x, double y) { return spire(x - 0.65, y + 0.65); }
/// Sheared, so that triangles are slivers far from Delaunay: scale factors alone do not make their edges close.
Mesh slanted(Mesh mesh) {
  for (Vec3& p : mesh.position) p.x += 4 * p.y;
  return mesh;
}
double on_cylinder(double x, double) { return std::sqrt(2.25 - x * x); }

Mesh hilly(double jitter = 0.25) { return shapes::height_field(kSide, hill, jitter); }

/// Vertices of the square's row or column through a vertex.
std::vector<Index> row(Index j) {
  std::vector<Index> chain;
  for (Index i = 0; i < kSide; ++i) chain.push_back(j * kSide + i);
  return chain;
}
std::vector<Index> column(Index i) {
  std::vector<Index> chain;
  for (Index j = 0; j < kSide; ++j) chain.push_back(j * kSide + i);
  return chain;
}

/// Lines of free lengths, and angles between them.
struct Lines {
  ConstraintSet set;
  std::vector<Feature> features;

  void add(const std::string& name, std::vector<Index> chain) {
    features.push_back({.name = name, .vertex = std::move(chain)});
    LineConstraint line{.feature = name};
    line.lengths = LineConstraint::Lengths::Free;
    set.constraints.push_back({name, "line", line});
  }
  void relate(const std::string& a, const std::string& b, double degrees) {
    AngleConstraint angle{};
    angle.features = {a, b};
    angle.degrees = degrees;
    set.constraints.push_back({a + " and " + b, "angle", angle});
  }
};

Result<Flattening> run(const Mesh& mesh, Method method, const Lines& lines = {}, int threads = 2) {
  FlattenOptions options;
  options.method = method;
  options.threads = threads;
  return flatten(mesh.surface(), {&lines.set, &lines.features}, options);
}

/// Farthest vertex from the chord of a chain, over its length.
double bend(const std::vector<Index>& chain, const std::vector<Vec2>& uv) {
  const Vec2 chord = uv[chain.back()] - uv[chain.front()];
  double farthest = 0;
  for (const Index v : chain)
    farthest = std::max(farthest, std::abs(cross(chord, uv[v] - uv[chain.front()])));
  return farthest / dot(chord, chord);
}

double degrees_between(const std::vector<Index>& a, const std::vector<Index>& b,
                       const std::vector<Vec2>& uv) {
  const Vec2 p = uv[a.back()] - uv[a.front()], q = uv[b.back()] - uv[b.front()];
  return 180 / kPi * std::atan2(std::abs(cross(p, q)), std::abs(dot(p, q)));
}

}  // namespace

TEST_CASE(
    "abf, yamabe: part of a cylinder is unrolled without distortion, by its map's own angles and lengths") {
  const Mesh mesh = shapes::height_field(kSide, on_cylinder,
                                         0);  // its edges lie along and across: triangles unroll exactly
  for (const Method method : {Method::Abf, Method::Yamabe}) {
    const auto flat = run(mesh, method);
    REQUIRE(flat);
    CHECK(flat->certificate.sigma_max.max == Approx(1).epsilon(1e-9));
    CHECK(flat->certificate.sigma_min.min == Approx(1).epsilon(1e-9));
    CHECK(flat->certificate.overlapping_pairs == 0);
  }
}

TEST_CASE("abf, yamabe: a flat frame stays as it is, and its hole too") {
  const Mesh mesh = shapes::frame(13, shapes::flat);
  for (const Method method : {Method::Abf, Method::Yamabe}) {
    const auto flat = run(mesh, method);
    REQUIRE(flat);
    CHECK(flat->certificate.arap < 1e-18);
    CHECK(flat->certificate.benchmark.average_angle_error < 1e-9);
  }
}

TEST_CASE("abf, yamabe: a curved frame has no flips, and angles nearer to the surface's than those of arap") {
  const Mesh mesh = shapes::frame(25, hill);
  const auto arap = run(mesh, Method::Arap);
  REQUIRE(arap);
  for (const Method method : {Method::Abf, Method::Yamabe}) {
    const auto flat = run(mesh, method);
    REQUIRE(flat);
    CHECK(flat->certificate.flipped_triangles == 0);
    CHECK(flat->certificate.overwound_vertices == 0);
    CHECK(flat->certificate.benchmark.average_angle_error <
          0.8 * arap->certificate.benchmark.average_angle_error);
  }
}

TEST_CASE("yamabe: the outer boundary keeps its edges' lengths") {
  for (const Mesh& mesh : {hilly(), shapes::frame(19, hill)}) {
    const auto flat = run(mesh, Method::Yamabe);
    REQUIRE(flat);
    const Topology topology = build_topology(Exec(1), mesh.surface());
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(0))) {
      const Index u = mesh.corner_vertex[c], v = mesh.corner_vertex[next_corner(c)];
      CHECK(norm(flat->uv[v] - flat->uv[u]) ==
            Approx(norm(mesh.position[v] - mesh.position[u])).epsilon(1e-10));
    }
  }
}

TEST_CASE(
    "yamabe: where the mesh's own edges do not close, flipped ones do, and the outer boundary keeps its "
    "lengths") {
  for (const Mesh& mesh :
       {slanted(shapes::height_field(21, spire)), slanted(shapes::height_field(21, spire, 0.4)),
        slanted(shapes::frame(25, spire_aside))}) {
    const auto flat = run(mesh, Method::Yamabe);
    REQUIRE(flat);
    CAPTURE(mesh.num_triangles());
    REQUIRE(flat->intrinsic);
    CHECK(flat->intrinsic->moved_edges > 0);
    CHECK(flat->intrinsic->angle_defect < 1e-9);
    const Topology topology = build_topology(Exec(1), mesh.surface());
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(0))) {
      const Index u = mesh.corner_vertex[c], v = mesh.corner_vertex[next_corner(c)];
      CHECK(norm(flat->uv[v] - flat->uv[u]) ==
            Approx(norm(mesh.position[v] - mesh.position[u])).epsilon(1e-9));
    }
  }
  CHECK_FALSE(run(hilly(), Method::Yamabe)->intrinsic);
}

TEST_CASE("yamabe: sides are straight and at their angles where edges are flipped too") {
  Lines lines;
  std::vector<Index> south, west;
  for (Index k = 0; k < 21; ++k) south.push_back(k), west.push_back(21 * k);
  lines.add("south", south);
  lines.add("west", west);
  lines.relate("south", "west", 75);
  const auto flat = run(slanted(shapes::height_field(21, spire)), Method::Yamabe, lines);
  REQUIRE(flat);
  REQUIRE(flat->intrinsic);
  CHECK(bend(south, flat->uv) < 1e-10);
  CHECK(bend(west, flat->uv) < 1e-10);
  CHECK(degrees_between(south, west, flat->uv) == Approx(75).epsilon(1e-10));
}

TEST_CASE("yamabe: a boundary that closes around no point is refused with the triangle, flips or not") {
  // Sides of 1, 1 and nearly 2 have a circumcentre outside, and the apex is as far from all three ends.
  Mesh tent;
  tent.position = {{-0.995, 0, 0}, {0.995, 0, 0}, {0, 0.0999, 0}, {0, -4.9, 5}};
  tent.corner_vertex = {0, 1, 3, 1, 2, 3, 2, 0, 3};
  const auto flat = run(tent, Method::Yamabe);
  REQUIRE(!flat);
  CHECK(flat.error().code == ErrorCode::NoConvergence);
  CHECK(flat.error().ids == std::vector<Index>{0});
  CHECK(flat.error().also.find("with edges flipped") != std::string::npos);
}

TEST_CASE("yamabe: length cross-ratios of all interior edges are those of the surface, holes or not") {
  for (const Mesh& mesh : {hilly(), shapes::frame(19, hill)}) {
    const auto flat = run(mesh, Method::Yamabe);
    REQUIRE(flat);
    CHECK(flat->certificate.area_ratio.max > 1.05 * flat->certificate.area_ratio.min);
    const Topology topology = build_topology(Exec(1), mesh.surface());
    for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
      const Index twin = topology.corner_twin[c];
      if (twin == kNone) continue;
      const Index i = mesh.corner_vertex[c], j = mesh.corner_vertex[next_corner(c)];
      const Index k = mesh.corner_vertex[previous_corner(c)], l = mesh.corner_vertex[previous_corner(twin)];
      const auto cross_ratio = [&](auto distance) {
        return distance(i, k) * distance(l, j) / (distance(k, j) * distance(i, l));
      };
      const double in_space =
          cross_ratio([&](Index a, Index b) { return norm(mesh.position[b] - mesh.position[a]); });
      CHECK(cross_ratio([&](Index a, Index b) { return norm(flat->uv[b] - flat->uv[a]); }) ==
            Approx(in_space).epsilon(1e-9));
    }
  }
}

TEST_CASE(
    "abf: lines inside, crossing, along the boundary and between them are straight, at the angles asked "
    "for") {
  const Mesh mesh = hilly();
  Lines lines;
  lines.add("across", row(6));
  lines.add("along", column(4));
  lines.add("side", row(0));
  lines.relate("across", "along", 70);
  lines.relate("side", "across", 0);
  const auto flat = run(mesh, Method::Abf, lines);
  REQUIRE(flat);
  for (const auto& chain : {row(6), column(4), row(0)}) CHECK(bend(chain, flat->uv) < 1e-11);
  CHECK(degrees_between(row(6), column(4), flat->uv) == Approx(70).epsilon(1e-11));
  CHECK(degrees_between(row(6), row(0), flat->uv) < 1e-9);
  for (const ConstraintOutcome& outcome : flat->constraints.outcome) CHECK(outcome.residual < 1e-9);
  CHECK(flat->certificate.flipped_triangles == 0);
  CHECK(flat->up_to_scale.empty());
}

TEST_CASE(
    "abf, yamabe: four straight sides with three right angles are a rectangle, and the fourth may be asked "
    "for too") {
  const Mesh mesh = hilly();
  for (const Method method : {Method::Abf, Method::Yamabe}) {
    for (const bool fourth : {false, true}) {
      Lines lines;
      lines.add("south", row(0));
      lines.add("east", column(kSide - 1));
      lines.add("north", row(kSide - 1));
      lines.add("west", column(0));
      lines.relate("south", "east", 90);
      lines.relate("east", "north", 90);
      lines.relate("north", "west", 90);
      if (fourth) lines.relate("west", "south", 90);
      const auto flat = run(mesh, method, lines);
      REQUIRE(flat);
      for (const auto& chain : {row(0), column(0), row(kSide - 1), column(kSide - 1)})
        CHECK(bend(chain, flat->uv) < 1e-11);
      CHECK(degrees_between(row(0), column(0), flat->uv) == Approx(90).epsilon(1e-11));
      CHECK(degrees_between(row(0), row(kSide - 1), flat->uv) < 1e-9);
      CHECK(flat->certificate.flipped_triangles == 0);
    }
  }
}

TEST_CASE("yamabe: lines that do not meet are turned against one another by the vertices between them") {
  Lines lines;
  lines.add("south", row(0));
  std::vector<Index> part = column(kSide - 1);
  part.erase(part.begin(), part.begin() + 4);
  lines.add("east", part);
  lines.relate("south", "east", 60);
  const auto flat = run(hilly(), Method::Yamabe, lines);
  REQUIRE(flat);
  CHECK(bend(part, flat->uv) < 1e-11);
  CHECK(degrees_between(row(0), part, flat->uv) == Approx(60).epsilon(1e-10));
}

TEST_CASE("abf: directions and pins place what angles leave open") {
  Lines lines;
  lines.add("across", row(6));
  DirectionConstraint direction{};
  direction.feature = "across";
  direction.degrees = 30;
  lines.set.constraints.push_back({"d", "direction", direction});
  lines.set.constraints.push_back({"p", "pin", PinConstraint{{3}, {{5, -2}}}});
  const auto flat = run(hilly(), Method::Abf, lines);
  REQUIRE(flat);
  CHECK(norm(flat->uv[3] - Vec2{5, -2}) < 1e-12);
  const Vec2 along = flat->uv[row(6).back()] - flat->uv[row(6).front()];
  CHECK(std::abs(std::remainder(argument(along) - kPi / 6, kPi)) < 1e-12);
  Lines pins;
  pins.set.constraints.push_back({"p", "pin", PinConstraint{{0, 20}, {{5, -2}, {7, 9}}}});
  const auto held = run(hilly(), Method::Abf, pins);
  REQUIRE(held);
  CHECK(norm(held->uv[0] - Vec2{5, -2}) < 1e-12);
  CHECK(norm(held->uv[20] - Vec2{7, 9}) < 1e-12);
  pins.set.constraints.push_back({"q", "pin", PinConstraint{{100}, {{1, 1}}}});
  const auto refused = run(hilly(), Method::Abf, pins);
  REQUIRE(!refused);
  CHECK(refused.error().code == ErrorCode::ConstraintUnsupported);
}

TEST_CASE("abf, yamabe: what they cannot express is refused with the reason") {
  Lines rim;
  rim.features.push_back({.name = "rim", .vertex = {16, 17, 32, 31}, .closed = true});
  CircleConstraint circle{};
  circle.feature = "rim";
  rim.set.constraints.push_back({"round", "circle", circle});
  for (const Method method : {Method::Abf, Method::Yamabe}) {
    const auto refused = run(hilly(), method, rim);
    REQUIRE(!refused);
    CHECK(refused.error().code == ErrorCode::ConstraintUnsupported);
    CHECK(refused.error().what.find("round") != std::string::npos);
  }
  Lines inside;
  inside.add("across", row(6));
  const auto refused = run(hilly(), Method::Yamabe, inside);
  REQUIRE(!refused);
  CHECK(refused.error().code == ErrorCode::ConstraintUnsupported);
  CHECK(refused.error().what.find("outer boundary") != std::string::npos);
}

TEST_CASE("abf: a line whose lengths were to be kept is straight, and it is said that they were not") {
  Lines lines;
  lines.add("across", row(6));
  std::get<LineConstraint>(lines.set.constraints[0].rule).lengths = LineConstraint::Lengths::Keep;
  const auto flat = run(hilly(), Method::Abf, lines);
  REQUIRE(flat);
  CHECK(bend(row(6), flat->uv) < 1e-11);
  CHECK(flat->up_to_scale == std::vector<std::string>{"across"});
}

TEST_CASE("abf, yamabe: angles that cannot close are a conflict") {
  Lines lines;
  lines.add("south", row(0));
  lines.add("east", column(kSide - 1));
  lines.add("north", row(kSide - 1));
  lines.add("west", column(0));
  lines.relate("south", "east", 90);
  lines.relate("east", "north", 90);
  lines.relate("north", "west", 90);
  lines.relate("west", "south", 80);
  for (const Method method : {Method::Abf, Method::Yamabe}) {
    const auto flat = run(hilly(), method, lines);
    REQUIRE(!flat);
    CHECK(flat.error().code == ErrorCode::ConstraintsConflict);
  }
}

TEST_CASE(
    "abf, yamabe: the map does not depend on the surface's place, and labels change its rounding only") {
  const Mesh mesh = hilly();
  std::vector<Index> new_of_old;
  const Mesh other = shapes::relabelled(shapes::rigid_motion(mesh, 11), 4, new_of_old);
  for (const Method method : {Method::Abf, Method::Yamabe}) {
    const auto a = run(mesh, method), b = run(other, method);
    REQUIRE(a);
    REQUIRE(b);
    for (Index v = 1; v < mesh.num_vertices(); ++v) {
      CHECK(norm(b->uv[new_of_old[v]] - b->uv[new_of_old[0]]) ==
            Approx(norm(a->uv[v] - a->uv[0])).epsilon(1e-8));
    }
  }
}

TEST_CASE("abf, yamabe: 1, 2 and 7 threads give the same bits, with flipped edges too") {
  for (const Mesh& mesh : {shapes::frame(60, hill), slanted(shapes::height_field(40, hill))}) {
    for (const Method method : {Method::Abf, Method::Yamabe}) {
      const auto one = run(mesh, method, {}, 1);
      REQUIRE(one);
      for (const int threads : {2, 7}) {
        const auto other = run(mesh, method, {}, threads);
        REQUIRE(other);
        CHECK(std::memcmp(one->uv.data(), other->uv.data(), sizeof(Vec2) * one->uv.size()) == 0);
      }
    }
  }
}
