#include "engine/constraints/region_shape.hpp"

#include "engine/constraints/fit.hpp"
#include "tests/engine/constraints/rest.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

Result<Body> shape_of(const Rest& rest, const Feature& region, const RegionMap& map = no_map) {
  const ConstraintSet set{.constraints = {named("plate", RegionConstraint{.feature = region.name})}};
  Body body{.kind = Body::Kind::Region, .constraint = 0, .feature = 0, .triangle = region.triangle};
  auto made = make_region(rest.surface, set, map, body);
  if (!made) return fail(made.error());
  return body;
}

bool everywhere(Vec3) { return true; }

/// Distance from flat coordinates of the input's vertices, by the best rotation and translation.
double misfit(const Rest& rest, const Body& body, In<Vec2> flat_of_input) {
  std::vector<Vec2> flat, placed;
  for (const Index v : body.vertex)
    flat.push_back((1 / rest.mesh().unit) * flat_of_input[rest.mesh().vertex_origin[v]]);
  const Placement at = best_placement(body.shape, flat, 1);
  for (const Vec2 t : body.shape) placed.push_back(at.p + multiply(at.c, t));
  return largest_distance(placed, flat);
}

/// A closed tube of n strips around, m rings high.
Mesh tube(Index n, Index m) {
  Mesh mesh = polar_mesh(m, n, 1, 2, 2 * kPi);
  for (Vec3& p : mesh.position) {
    const double r = std::hypot(p.x, p.y);
    p = {p.x / r, p.y / r, 2 * r};
  }
  return mesh;
}

double bump(double x, double y) { return 0.5 * std::exp(-2 * (x * x + y * y)); }

}  // namespace

TEST_CASE(
    "region: of a plane it is congruent, its vertices ascend as in the input and its triangles stay "
    "positive") {
  const Mesh mesh = shapes::height_field(12, shapes::flat);
  std::vector<Vec2> flat;
  for (const Vec3 p : mesh.position) flat.push_back({p.x, p.y});
  const Rest rest(shapes::rigid_motion(mesh, 8));
  const Feature part = rest.region("r", [&](Vec3 p) {
    return norm(p - rest.mesh().centre) < 0.6;  // round the middle
  });
  REQUIRE(part.triangle.size() > 20);
  const auto body = shape_of(rest, part);
  REQUIRE(body);
  CHECK(misfit(rest, *body, flat) < 1e-13);
  CHECK(body->planarity < 1e-12);
  std::vector<Index> origin, place(rest.mesh().num_vertices(), kNone);
  for (std::size_t i = 0; i < body->vertex.size(); ++i) {
    origin.push_back(rest.mesh().vertex_origin[body->vertex[i]]);
    place[body->vertex[i]] = static_cast<Index>(i);
  }
  CHECK(std::is_sorted(origin.begin(), origin.end()));
  for (const Index t : part.triangle) {
    const Index* v = &rest.mesh().corner_vertex[3 * static_cast<std::size_t>(t)];
    const Vec2 a = body->shape[place[v[0]]], b = body->shape[place[v[1]]], c = body->shape[place[v[2]]];
    CHECK(cross(b - a, c - a) > 0);
  }
}

TEST_CASE("region: a bent sheet unrolls to the flat one to 1e-12") {
  for (const double bend : {0.02, 0.2, -0.3}) {
    const BentSheet sheet = bent_sheet(20, bend);
    const Rest rest(sheet.mesh);
    const auto body = shape_of(rest, rest.region("r", everywhere));
    REQUIRE(body);
    CHECK(misfit(rest, *body, sheet.flat) < 1e-12);
    CHECK(body->planarity < 1e-12);
  }
}

TEST_CASE("region: a flat ring closes around its hole, a full tube does not and asks for a seam") {
  const Rest ring(polar_mesh(3, 24, 1, 2, 2 * kPi));
  CHECK(shape_of(ring, ring.region("r", everywhere)));
  const Rest whole(tube(24, 6));
  const auto refused = shape_of(whole, whole.region("r", everywhere));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::ConstraintsConflict);
  CHECK(refused.error().what.find("\"plate\"") != std::string::npos);
  CHECK(refused.error().what.find("seam") != std::string::npos);
  CHECK(refused.error().what.find("360 degrees") != std::string::npos);
}

TEST_CASE("region: a part of a tube that does not go around unrolls") {
  const Mesh mesh = tube(24, 6);
  const Rest rest(mesh);
  const auto body = shape_of(rest, rest.region("r", [](Vec3 p) { return p.x > -0.5; }));
  REQUIRE(body);
  CHECK(body->planarity < 1e-12);
}

TEST_CASE("region: where it is not developable the map is asked once, and its worst stretch is reported") {
  const Rest rest(shapes::height_field(12, bump));
  int calls = 0;
  const auto body = shape_of(rest, rest.region("r", everywhere), [&](const Surface& region) {
    ++calls;
    std::vector<Vec2> uv;
    for (const Vec3 p : region.position) uv.push_back({p.x + 7, p.y});
    return Result<std::vector<Vec2>>(uv);
  });
  REQUIRE(body);
  CHECK(calls == 1);
  double steepest = 0;  // of the projection along z: an edge's length over its shadow
  for (Index c = 0; c < static_cast<Index>(rest.mesh().corner_vertex.size()); ++c) {
    const Vec3 e = rest.mesh().position[rest.mesh().corner_vertex[next_corner(c)]] -
                   rest.mesh().position[rest.mesh().corner_vertex[c]];
    steepest = std::max(steepest, 1 - std::hypot(e.x, e.y) / norm(e));
  }
  CHECK(body->planarity == doctest::Approx(steepest).epsilon(1e-10));
  Vec2 sum{};
  for (const Vec2 t : body->shape) sum += t;
  CHECK(norm(sum) < 1e-12);
}

TEST_CASE("region: a map that fails is told with the constraint's name") {
  const Rest rest(shapes::height_field(12, bump));
  const auto body = shape_of(rest, rest.region("r", everywhere), [](const Surface&) {
    return Result<std::vector<Vec2>>(fail(ErrorCode::ConstraintsConflict, "turns over 3 triangles"));
  });
  REQUIRE_FALSE(body);
  CHECK(body.error().code == ErrorCode::ConstraintsConflict);
  CHECK(body.error().what.find("\"plate\"") != std::string::npos);
  CHECK(body.error().what.find("turns over 3 triangles") != std::string::npos);
}

TEST_CASE("region: one that touches itself in a vertex has no shape") {
  const Mesh mesh = shapes::height_field(6, shapes::flat, 0);
  const Rest rest(mesh);
  // Two cells that have only their common corner, the vertex (2, 2), in common.
  const auto body = shape_of(rest, rest.region("r", [](Vec3 p) {
    const double x = 2.5 * (p.x + 1), y = 2.5 * (p.y + 1);  // in cells
    return (x > 1 && x < 2 && y > 1 && y < 2) || (x > 2 && x < 3 && y > 2 && y < 3);
  }));
  REQUIRE_FALSE(body);
  CHECK(body.error().what.find("touches itself in a vertex") != std::string::npos);
}
