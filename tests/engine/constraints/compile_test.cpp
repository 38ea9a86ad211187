#include "engine/constraints/compile.hpp"

#include "tests/engine/constraints/rest.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

constexpr Index kN = 9;

/// A flat grid with a row, a column that crosses nothing, a loop and a patch.
struct Compiling {
  Rest rest{shapes::scaled(shapes::height_field(kN, shapes::flat, 0), 10)};
  std::vector<Feature> features;
  std::vector<Index> vertex_origin;

  Compiling() {
    features = {rest.chain("row", grid_path(kN, 1, 2, 6, 2)), rest.chain("column", grid_path(kN, 7, 1, 7, 6)),
                rest.chain("loop", grid_loop(kN, 2, 4, 5, 7), true),
                rest.region("patch", [](Vec3 p) { return p.y > 8; })};
  }
  Result<Compiled> operator()(std::vector<Constraint> constraints) const {
    const ConstraintSet set{.constraints = std::move(constraints)};
    return compile(rest.surface, {&set, features, vertex_origin}, no_map);
  }
};

Constraint line(const std::string& feature) { return named(feature, LineConstraint{.feature = feature}); }
Constraint angle(AngleConstraint rule) { return named("relation", std::move(rule)); }

}  // namespace

TEST_CASE("compile: a relation measures the line of a feature wherever it is in the file, else its chord") {
  const Compiling compile;
  const auto compiled =
      compile({angle({.features = {"row", "column"}, .degrees = 30, .oriented = true}), line("row")});
  REQUIRE(compiled);
  REQUIRE(compiled->bodies.size() == 2);
  REQUIRE(compiled->relations.size() == 1);
  const Relation& r = compiled->relations[0];
  CHECK(r.constraint == 0);
  CHECK(r.degrees == 30);
  CHECK(r.oriented);
  CHECK(compiled->bodies[r.a].kind == Body::Kind::Line);
  const Body& chord = compiled->bodies[r.b];
  CHECK(chord.kind == Body::Kind::Chord);
  CHECK_FALSE(chord.scale.has_value());
  CHECK_FALSE(chord.adjacent);
  CHECK(chord.vertex ==
        std::vector<Index>{compile.features[1].vertex.front(), compile.features[1].vertex.back()});
}

TEST_CASE("compile: one chord serves all relations that measure it; edges are chords of the mesh") {
  const Compiling compile;
  const auto compiled =
      compile({angle({.features = {"row", "column"}}), angle({.features = {"column", "row"}}),
               angle({.edges = {{{0, 1}, {40, 41}}}}),
               named("d", DirectionConstraint{.edge = std::array<Index, 2>{0, 1}})});
  REQUIRE(compiled);
  CHECK(compiled->bodies.size() == 4);
  CHECK(compiled->relations[0].a == compiled->relations[1].b);
  CHECK(compiled->relations[3].a == kNone);
  CHECK(compiled->relations[3].b == compiled->relations[2].a);
  CHECK(compiled->bodies[compiled->relations[2].a].adjacent);
}

TEST_CASE("compile: edges and pins are in the numbers of the input; pins in units of the ordered mesh") {
  Compiling compile;
  for (Index v = 0; v < kN * kN; ++v) compile.vertex_origin.push_back(1000 + v);
  const auto compiled = compile({named("pin", PinConstraint{.vertex = {1005}, .uv = {{30, -10}}}),
                                 named("d", DirectionConstraint{.edge = std::array<Index, 2>{1003, 1004}})});
  REQUIRE(compiled);
  REQUIRE(compiled->pins.size() == 1);
  CHECK(compiled->pins[0].vertex == compile.rest.here[5]);
  CHECK(norm(compiled->pins[0].uv - Vec2{1.5, -0.5}) < 1e-15);  // the sheet is 20 wide
  CHECK(compiled->bodies[0].vertex == std::vector<Index>{compile.rest.here[3], compile.rest.here[4]});
}

TEST_CASE("compile: sizes are the chain's length and the square root of the region's area") {
  const Compiling compile;
  const auto compiled = compile({line("row"), named("patch", RegionConstraint{.feature = "patch"})});
  REQUIRE(compiled);
  CHECK(compile.rest.mesh().unit * compiled->bodies[0].size == doctest::Approx(12.5).epsilon(1e-13));
  CHECK(compile.rest.mesh().unit * compiled->bodies[1].size ==
        doctest::Approx(std::sqrt(20 * 2.5)).epsilon(1e-13));
}

TEST_CASE("compile: what does not fit its feature is refused with the constraint's name and place") {
  Compiling compile;
  compile.features.push_back(compile.rest.chain("knot", {20, 21, 22, 13, 12, 21}));
  const std::pair<Constraint, const char*> cases[] = {
      {named("bad", LineConstraint{.feature = "nowhere"}), "nowhere"},
      {named("bad", LineConstraint{.feature = "patch"}), "region"},
      {named("bad", RegionConstraint{.feature = "row"}), "curve"},
      {named("bad", CurveConstraint{.feature = "knot"}), "passes a vertex twice"},
      {named("bad", AngleConstraint{.features = {"row", "loop"}}), "closed"},
      {named("bad", AngleConstraint{.features = {"row", "patch"}}), "region"},
      {named("bad", AngleConstraint{.features = {"row", "row"}}), "one"},
      {named("bad", AngleConstraint{.features = {"column", "row"}, .measure = Measure::Line}), "line"},
      {named("bad", DirectionConstraint{.edge = std::array<Index, 2>{0, 80}}), "edge"}};
  for (const auto& [constraint, word] : cases) {
    const auto refused = compile({line("column"), constraint});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::ConstraintInvalid);
    CHECK(refused.error().what.find("\"bad\"") != std::string::npos);
    CHECK(refused.error().what.find(word) != std::string::npos);
    CHECK(refused.error().place.pointer == "/constraints/1");
  }
}

TEST_CASE(
    "compile: a vertex that is pinned to two places is a conflict of both pins, to one place it is not") {
  const Compiling compile;
  const Constraint first = named("first", PinConstraint{.vertex = {4, 5}, .uv = {{1, 2}, {3, 4}}});
  CHECK(compile({first, named("same", PinConstraint{.vertex = {5}, .uv = {{3, 4}}})})->pins.size() == 2);
  const auto refused =
      compile({first, line("row"), named("other", PinConstraint{.vertex = {5}, .uv = {{3, 5}}})});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::ConstraintsConflict);
  CHECK(refused.error().ids == std::vector<Index>{0, 2});
}

TEST_CASE("compile: along a seam a side is compared with its own side only") {
  Compiling compile;
  Feature other = compile.features[0];
  other.vertex = compile.rest.chain("row", grid_path(kN, 1, 3, 6, 3)).vertex;  // stands for the other copy
  compile.features[0].side = 1;
  other.side = 2;
  compile.features.push_back(other);
  const auto with_column = compile({line("row"), line("column"), angle({.features = {"row", "column"}})});
  REQUIRE(with_column);
  CHECK(with_column->bodies.size() == 3);
  CHECK(with_column->relations.size() == 2);
  compile.features[1].side = 2;
  const auto second_side = compile({line("row"), line("column"), angle({.features = {"row", "column"}})});
  REQUIRE(second_side);
  REQUIRE(second_side->relations.size() == 1);
  CHECK(second_side->bodies[second_side->relations[0].a].feature == 4);
}
