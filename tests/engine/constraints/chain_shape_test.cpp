#include "engine/constraints/chain_shape.hpp"

#include "engine/constraints/fit.hpp"
#include "tests/engine/constraints/rest.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

/// The template of one feature, the constraint called "it".
template <class Rule>
Result<Body> shape_of(const Rest& rest, const Feature& chain, const Rule& rule,
                      Result<void> (*make)(const ChainInput&, const Rule&, Body&)) {
  const ConstraintSet set{.constraints = {named("it", rule)}};
  Chirality chirality(rest.surface);
  Body body{.constraint = 0, .feature = 0, .vertex = chain.vertex, .closed = chain.closed};
  for (const double l : edge_lengths(rest.surface, chain.vertex, chain.closed)) body.size += l;
  auto made = make({&rest.surface, &set, 0, &chain, &chirality}, rule, body);
  if (!made) return fail(made.error());
  return body;
}

double largest_edge_error(const Rest& rest, const Body& body) {
  const std::vector<double> length = edge_lengths(rest.surface, body.vertex, body.closed);
  double worst = 0;
  for (std::size_t i = 0; i < length.size(); ++i) {
    const Vec2 edge = body.shape[(i + 1) % body.shape.size()] - body.shape[i];
    worst = std::max(worst, std::abs(norm(edge) - length[i]));
  }
  return worst;
}

Vec2 mean(In<Vec2> point) {
  Vec2 sum{};
  for (const Vec2 p : point) sum += p;
  return (1.0 / static_cast<double>(point.size())) * sum;
}

/// Sum of the turning angles at inner vertices; positive: left.
double turning_of(In<Vec2> point, bool closed) {
  double sum = 0;
  const std::size_t n = point.size();
  for (std::size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < n; ++i) {
    const Vec2 before = point[i] - point[(i + n - 1) % n], after = point[(i + 1) % n] - point[i];
    sum += std::atan2(cross(before, after), dot(before, after));
  }
  return sum;
}

/// Distance from flat coordinates of the chain's vertices, by the best rotation and translation.
double misfit(const Body& body, std::vector<Vec2> flat, double unit) {
  for (Vec2& p : flat) p = (1 / unit) * p;
  const Placement at = best_placement(body.shape, flat, 1);
  std::vector<Vec2> placed;
  for (const Vec2 t : body.shape) placed.push_back(at.p + multiply(at.c, t));
  return largest_distance(placed, flat);
}

std::vector<Vec2> seen_from_above(const Mesh& mesh, In<Index> chain) {
  std::vector<Vec2> flat;
  for (const Index v : chain) flat.push_back({mesh.position[v].x, mesh.position[v].y});
  return flat;
}

/// Ring j of a polar mesh, or a part of it.
std::vector<Index> ring(Index columns, Index j, Index from, Index to) {
  std::vector<Index> chain;
  for (Index i = from; i <= to; ++i) chain.push_back(j * columns + i);
  return chain;
}

double bump(double x, double y) { return 0.5 * std::exp(-2 * (x * x + y * y)); }
double saddle(double x, double y) { return 0.1 * (x * x - y * y); }

}  // namespace

TEST_CASE("line: its template is straight, centred and has the chain's lengths; options decide its scale") {
  const Index n = 10;
  const Rest rest(shapes::wavy_disk(2 * (n - 1) * (n - 1)));
  const Feature chain = rest.chain("sill", grid_path(n, 2, 1, 2, 8));
  using Lengths = LineConstraint::Lengths;
  const auto keep = shape_of(rest, chain, LineConstraint{.feature = "sill"}, make_line);
  REQUIRE(keep);
  CHECK(keep->kind == Body::Kind::Line);
  CHECK(keep->scale == 1);
  CHECK(largest_edge_error(rest, *keep) < 1e-14);
  CHECK(norm(mean(keep->shape)) < 1e-15);
  for (std::size_t i = 1; i < keep->shape.size(); ++i) {
    CHECK(keep->shape[i].y == keep->shape[0].y);
    CHECK(keep->shape[i].x > keep->shape[i - 1].x);
  }
  const auto scaled = shape_of(
      rest, chain,
      LineConstraint{.feature = "sill", .lengths = Lengths::Scale, .scale = {.factor = {}, .group = "g"}},
      make_line);
  CHECK(scaled->kind == Body::Kind::Line);
  CHECK_FALSE(scaled->scale.has_value());
  CHECK(scaled->scale_group == "g");
  CHECK(shape_of(rest, chain, LineConstraint{.feature = "sill", .lengths = Lengths::Free, .scale = {}},
                 make_line)
            ->kind == Body::Kind::FreeLine);
}

TEST_CASE("line: a closed chain is refused by name") {
  const Rest rest(shapes::height_field(8, shapes::flat));
  const Feature loop = rest.chain("rim", grid_loop(8, 2, 2, 5, 5), true);
  const auto body = shape_of(rest, loop, LineConstraint{.feature = "rim"}, make_line);
  REQUIRE_FALSE(body);
  CHECK(body.error().code == ErrorCode::ConstraintsConflict);
  CHECK(body.error().what.find("\"it\"") != std::string::npos);
  CHECK(body.error().what.find("\"rim\"") != std::string::npos);
  CHECK(body.error().place.pointer == "/constraints/0");
}

TEST_CASE(
    "circle: closed chains keep their edge lengths on a circle and turn the way they run on the surface") {
  const Index n = 12;
  const Rest rest(shapes::height_field(n, bump));
  std::vector<Index> vertex = grid_loop(n, 2, 3, 9, 7);
  for (const bool forwards : {true, false}) {
    const Feature loop = rest.chain("arch", vertex, true);
    const auto body = shape_of(rest, loop, CircleConstraint{.feature = "arch"}, make_circle);
    REQUIRE(body);
    CHECK(largest_edge_error(rest, *body) < 1e-13);
    const BestCircle circle = best_circle(body->shape);
    for (const Vec2 t : body->shape) CHECK(std::abs(norm(t - circle.centre) - circle.radius) < 1e-13);
    CHECK((doubled_area(body->shape) > 0) == forwards);
    CHECK(norm(mean(body->shape)) < 1e-14);
    CHECK_FALSE(body->scale.has_value());
    CHECK_FALSE(body->mirrored);
    std::reverse(vertex.begin(), vertex.end());
  }
}

TEST_CASE("circle: a hole runs clockwise with the surface on its left") {
  const Rest rest(polar_mesh(3, 16, 1, 2, 2 * kPi));
  std::vector<Index> hole = ring(16, 0, 0, 15);
  std::reverse(hole.begin(), hole.end());  // clockwise: the surface is on its left
  const auto body =
      shape_of(rest, rest.chain("hole", hole, true), CircleConstraint{.feature = "hole"}, make_circle);
  REQUIRE(body);
  CHECK(doubled_area(body->shape) < 0);
  CHECK(misfit(*body, seen_from_above(polar_mesh(3, 16, 1, 2, 2 * kPi), hole), rest.mesh().unit) < 1e-13);
}

TEST_CASE("circle: a given radius becomes the scale that gives it in mesh units") {
  const Rest rest(shapes::scaled(shapes::height_field(12, bump), 300));
  const Feature loop = rest.chain("arch", grid_loop(12, 2, 3, 9, 7), true);
  const auto body = shape_of(rest, loop, CircleConstraint{.feature = "arch", .radius = 123.0}, make_circle);
  REQUIRE(body);
  CHECK(*body->scale * best_circle(body->shape).radius * rest.mesh().unit ==
        doctest::Approx(123).epsilon(1e-12));
}

TEST_CASE("circle: options of arcs are refused on closed chains, and chains of 2 vertices altogether") {
  const Rest rest(shapes::height_field(8, shapes::flat));
  const Feature loop = rest.chain("rim", grid_loop(8, 2, 2, 5, 5), true);
  const Feature edge = rest.chain("edge", grid_path(8, 2, 2, 3, 2));
  for (const auto& refused :
       {shape_of(rest, loop, CircleConstraint{.feature = "rim", .sweep_degrees = 90.0}, make_circle),
        shape_of(rest, loop, CircleConstraint{.feature = "rim", .mirror = true}, make_circle),
        shape_of(rest, edge, CircleConstraint{.feature = "edge"}, make_circle)}) {
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::ConstraintInvalid);
  }
}

TEST_CASE(
    "arc: of a chain on a circle it is that arc, from nearly straight to nearly closed, left and right") {
  for (const double degrees : {0.2, 10.0, 90.0, 179.0, 181.0, 270.0, 340.0}) {
    const Mesh mesh = polar_mesh(4, 24, 1, 2, degrees * kPi / 180);
    const Rest rest(mesh);
    std::vector<Index> vertex = ring(25, 2, 0, 24);
    for (const double side : {1.0, -1.0}) {
      const auto body =
          shape_of(rest, rest.chain("arch", vertex), CircleConstraint{.feature = "arch"}, make_circle);
      REQUIRE(body);
      CHECK(misfit(*body, seen_from_above(mesh, vertex), rest.mesh().unit) < 1e-10);
      CHECK(largest_edge_error(rest, *body) < 1e-13);
      CHECK(turning_of(body->shape, false) ==
            doctest::Approx(side * degrees * kPi / 180 * 23 / 24).epsilon(1e-7));
      CHECK_FALSE(body->mirrored);
      CHECK_FALSE(body->chirality_open);
      std::reverse(vertex.begin(), vertex.end());
    }
  }
}

TEST_CASE("arc: a given sweep replaces its own, and mirror turns it to the other side") {
  const Rest rest(polar_mesh(4, 24, 1, 2, 1.0));
  const Feature chain = rest.chain("arch", ring(25, 2, 0, 24));
  for (const double degrees : {20.0, 200.0, 350.0}) {
    CircleConstraint rule{.feature = "arch", .sweep_degrees = degrees};
    const auto body = shape_of(rest, chain, rule, make_circle);
    REQUIRE(body);
    CHECK(turning_of(body->shape, false) == doctest::Approx(degrees * kPi / 180 * 23 / 24).epsilon(1e-10));
    rule.mirror = true;
    const auto mirrored = shape_of(rest, chain, rule, make_circle);
    CHECK(mirrored->mirrored);
    CHECK(turning_of(mirrored->shape, false) ==
          doctest::Approx(-degrees * kPi / 180 * 23 / 24).epsilon(1e-10));
  }
}

TEST_CASE("arc: a straight chain has no circle; with a sweep it has, and winding more than once is refused") {
  const Rest rest(shapes::height_field(9, shapes::flat));
  const Feature straight = rest.chain("edge", grid_path(9, 0, 0, 8, 0));
  const auto refused = shape_of(rest, straight, CircleConstraint{.feature = "edge"}, make_circle);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::ConstraintInvalid);
  CHECK(refused.error().what.find("straight") != std::string::npos);
  const auto bent =
      shape_of(rest, straight, CircleConstraint{.feature = "edge", .sweep_degrees = 30.0}, make_circle);
  REQUIRE(bent);
  CHECK(std::abs(turning_of(bent->shape, false)) == doctest::Approx(kPi / 6 * 7 / 8).epsilon(1e-10));
}

TEST_CASE("curve: a planar chain keeps its shape, however the mesh lies in space") {
  const Index n = 10;
  const Mesh mesh = shapes::height_field(n, shapes::flat);
  std::vector<Index> open = grid_path(n, 1, 2, 7, 2), closed = grid_loop(n, 2, 2, 6, 5);
  for (const Index v : grid_path(n, 7, 3, 7, 8)) open.push_back(v);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Rest rest(shapes::rigid_motion(mesh, seed));
    for (const bool forwards : {true, false}) {
      const auto curve = shape_of(rest, rest.chain("c", open), CurveConstraint{.feature = "c"}, make_curve);
      const auto loop =
          shape_of(rest, rest.chain("l", closed, true), CurveConstraint{.feature = "l"}, make_curve);
      REQUIRE(curve);
      REQUIRE(loop);
      CHECK(misfit(*curve, seen_from_above(mesh, open), rest.mesh().unit) < 1e-13);
      CHECK(misfit(*loop, seen_from_above(mesh, closed), rest.mesh().unit) < 1e-13);
      CHECK(curve->planarity < 1e-14);
      CHECK((doubled_area(loop->shape) > 0) == forwards);
      CHECK_FALSE(curve->chirality_open);
      std::reverse(open.begin(), open.end());
      std::reverse(closed.begin(), closed.end());
    }
  }
}

TEST_CASE("curve: planarity is the farthest vertex from the plane") {
  const Index n = 11;
  const Rest rest(shapes::height_field(n, saddle, 0));
  const auto loop = shape_of(rest, rest.chain("l", grid_loop(n, 0, 0, 10, 10), true),
                             CurveConstraint{.feature = "l"}, make_curve);
  REQUIRE(loop);
  // Over the square's rim the saddle is highest in the middle of two sides and lowest in that of the others.
  CHECK(rest.mesh().unit * loop->planarity == doctest::Approx(0.1).epsilon(1e-12));
}

TEST_CASE(
    "curve: a profile whose plane stands across the surface leaves its chirality open unless mirror is "
    "given") {
  const Index n = 11;
  const Rest rest(shapes::height_field(
      n, [](double x, double) { return 0.4 * x * x; }, 0));
  const Feature profile = rest.chain("p", grid_path(n, 1, 5, 9, 5));
  const auto open = shape_of(rest, profile, CurveConstraint{.feature = "p"}, make_curve);
  REQUIRE(open);
  CHECK(open->chirality_open);
  CHECK(open->planarity < 1e-14);
  const auto plain = shape_of(rest, profile, CurveConstraint{.feature = "p", .mirror = false}, make_curve);
  const auto mirrored = shape_of(rest, profile, CurveConstraint{.feature = "p", .mirror = true}, make_curve);
  CHECK_FALSE(plain->chirality_open);
  CHECK_FALSE(mirrored->chirality_open);
  CHECK(mirrored->mirrored);
  CHECK(turning_of(plain->shape, false) == doctest::Approx(-turning_of(mirrored->shape, false)));
}

TEST_CASE("curve: a straight chain in space becomes straight; its plane is the surface's") {
  const Rest rest(shapes::height_field(9, shapes::flat, 0));
  const auto body =
      shape_of(rest, rest.chain("s", grid_path(9, 1, 4, 7, 4)), CurveConstraint{.feature = "s"}, make_curve);
  REQUIRE(body);
  CHECK_FALSE(body->chirality_open);
  CHECK(turning_of(body->shape, false) == doctest::Approx(0));
  CHECK(body->planarity < 1e-15);
}

TEST_CASE("geodesic: on a bent sheet a curve takes the shape that it has on the flat one, open and closed") {
  const Index n = 12;
  const BentSheet sheet = bent_sheet(n, 0.15);
  const Rest rest(sheet.mesh);
  std::vector<Index> open = grid_path(n, 1, 2, 8, 2), closed = grid_loop(n, 2, 2, 9, 8);
  for (const Index v : grid_path(n, 8, 3, 8, 9)) open.push_back(v);
  const std::vector<Index> rim = grid_loop(n, 0, 0, 11, 11);
  const auto flat = [&](In<Index> chain) {
    std::vector<Vec2> point;
    for (const Index v : chain) point.push_back(sheet.flat[v]);
    return point;
  };
  const CurveConstraint rule{.feature = "c", .shape = CurveConstraint::Shape::Geodesic, .scale = {}};
  for (const auto& [chain, is_closed] : {std::pair(open, false), {closed, true}, {rim, true}}) {
    const auto body = shape_of(rest, rest.chain("c", chain, is_closed), rule, make_curve);
    REQUIRE(body);
    CHECK(misfit(*body, flat(chain), rest.mesh().unit) < 1e-12);
    CHECK(largest_edge_error(rest, *body) < 1e-14);
    CHECK(body->planarity > 0.01);  // far from planar, and reported
  }
}

TEST_CASE(
    "geodesic: around a bump the curve is closed in the plane with its lengths, by the smallest change") {
  const Index n = 14;
  const Rest rest(shapes::height_field(n, bump));
  std::vector<Index> chain = grid_loop(n, 3, 3, 10, 10);
  for (const double total : {2 * kPi, -2 * kPi}) {
    const Feature loop = rest.chain("c", chain, true);
    const auto body = shape_of(
        rest, loop, CurveConstraint{.feature = "c", .shape = CurveConstraint::Shape::Geodesic, .scale = {}},
        make_curve);
    REQUIRE(body);
    CHECK(largest_edge_error(rest, *body) < 1e-14);
    CHECK(turning_of(body->shape, true) == doctest::Approx(total).epsilon(1e-13));
    std::reverse(chain.begin(), chain.end());
  }
}

TEST_CASE("centre: moves points so that their mean is the origin, and keeps their differences") {
  std::vector<Vec2> shape = {{1, 2}, {4, 2}, {4, 8}};
  centre(shape);
  CHECK(shape == std::vector<Vec2>{{-2, -2}, {1, -2}, {1, 4}});
}
