#include "io/constraints_json.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "io/file.hpp"
#include "io/json_document.hpp"
#include "tests/io/io_support.hpp"

using namespace planish;
using test::TemporaryFolder;

namespace {

Result<ConstraintSet> parse(const std::string& text, const std::string& folder = "") {
  return parse_constraints(Exec(), text, "c.json", folder);
}

ConstraintSet must_parse(const std::string& text, const std::string& folder = "") {
  auto set = parse(text, folder);
  if (!set) FAIL(describe(set.error()));
  return std::move(*set);
}

/// A file with features a, b (lines), ring (closed), patch (a region), and these constraints.
std::string with_constraints(const std::string& constraints) {
  return R"({"version": 1, "features": {"a": {"polyline": [[0,0,0],[1,0,0]]}, "b": {"vertices": [1,2]},
    "ring": {"loop": 1}, "patch": {"triangles": [0]}}, "constraints": [)" +
         constraints + "]}";
}

std::string with_feature(const std::string& feature) {
  return R"({"version": 1, "features": {"x": )" + feature + "}}";
}

template <class T>
T rule(const std::string& constraint) {
  const ConstraintSet set = must_parse(with_constraints(constraint));
  REQUIRE(set.constraints.size() == 1);
  REQUIRE(std::holds_alternative<T>(set.constraints[0].rule));
  return std::get<T>(set.constraints[0].rule);
}

template <class T>
T source(const std::string& feature) {
  const ConstraintSet set = must_parse(with_feature(feature));
  REQUIRE(set.features.size() == 1);
  REQUIRE(std::holds_alternative<T>(set.features[0].source));
  return std::get<T>(set.features[0].source);
}

struct Wrong {
  std::string text;
  std::string pointer;
  std::string message;  // part of it
};

void check_wrong(const std::vector<Wrong>& cases, ErrorCode code = ErrorCode::BadSyntax) {
  for (const Wrong& wrong : cases) {
    CAPTURE(wrong.text);
    const auto set = parse(wrong.text);
    REQUIRE(!set.has_value());
    CHECK(set.error().code == code);
    CHECK(set.error().place.file == "c.json");
    CHECK(set.error().place.pointer == wrong.pointer);
    CHECK_MESSAGE(set.error().what.find(wrong.message) != std::string::npos, set.error().what);
  }
}

/// The documents in ```json fences.
std::vector<std::string> fenced_json(const std::string& path) {
  std::ifstream file(path);
  REQUIRE(file.good());
  std::vector<std::string> blocks;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      inside = line == "```json";
      if (inside) blocks.emplace_back();
    } else if (inside) {
      blocks.back() += line + "\n";
    }
  }
  return blocks;
}

}  // namespace

TEST_CASE("constraints_json: every kind of feature arrives with its numbers") {
  const auto line = source<PolylineSource>(R"({"polyline": [[0.1, -2e-3, 3]], "max_distance": 0.5})");
  CHECK(line.point == std::vector<Vec3>{{0.1, -2e-3, 3}});
  CHECK(!line.closed);
  CHECK(line.max_distance == 0.5);
  CHECK(!source<PolylineSource>(R"({"polyline": [[0,0,0]]})").max_distance.has_value());
  CHECK(source<PolylineSource>(R"({"closed": true, "polyline": [[0,0,0]]})").closed);
  const auto chain = source<VertexSource>(R"({"vertices": [12, 2147483647, 3.0], "closed": true})");
  CHECK(chain.vertex == std::vector<Index>{12, 2147483647, 3});
  CHECK(chain.closed);
  CHECK(!chain.shortest);
  CHECK(source<VertexSource>(R"({"vertices": [1, 9], "join": "shortest"})").shortest);
  CHECK(!source<VertexSource>(R"({"vertices": [1, 9], "join": "edges"})").shortest);
  CHECK(source<LoopSource>(R"({"loop": 4})").loop == 4);
  CHECK(source<BoundaryNearSource>(R"({"boundary_near": [1, 2, 3]})").point == Vec3{1, 2, 3});
  CHECK(source<TriangleSource>(R"({"triangles": [7, 8]})").triangle == std::vector<Index>{7, 8});
  const auto cut = source<PlaneCutSource>(
      R"({"plane_cut": {"near": [7, 8, 9], "point": [1, 2, 3], "normal": [0, 0, -1]}})");
  CHECK(cut.point == Vec3{1, 2, 3});
  CHECK(cut.normal == Vec3{0, 0, -1});
  CHECK(cut.near == Vec3{7, 8, 9});
  const auto sharp = source<SharpEdgesSource>(R"({"sharp_edges": {"degrees": 40.5, "near": [1, 2, 3]}})");
  CHECK(sharp.degrees == 40.5);
  CHECK(sharp.near == Vec3{1, 2, 3});
}

TEST_CASE("constraints_json: enclosed_by may name a feature that comes later") {
  const auto set = must_parse(
      R"({"version": 1, "features": {"in": {"enclosed_by": "rim", "seed": [1, 2, 3]}, "rim": {"loop": 0}}})");
  const auto region = std::get<EnclosedBySource>(set.features[0].source);
  CHECK(set.features[0].name == "in");
  CHECK(region.feature == "rim");
  CHECK(region.seed == Vec3{1, 2, 3});
  CHECK(set.features[1].name == "rim");
}

TEST_CASE("constraints_json: lines") {
  using Lengths = LineConstraint::Lengths;
  const auto keep = rule<LineConstraint>(R"({"type": "line", "feature": "a"})");
  CHECK(keep.feature == "a");
  CHECK(keep.lengths == Lengths::Keep);
  CHECK(rule<LineConstraint>(R"({"type": "line", "feature": "a", "lengths": "free"})").lengths ==
        Lengths::Free);
  const auto scaled = rule<LineConstraint>(R"({"type": "line", "feature": "a", "lengths": "scale"})");
  CHECK(scaled.lengths == Lengths::Scale);
  CHECK(!scaled.scale.factor.has_value());
  const std::string head = R"({"type": "line", "feature": "a", "lengths": "scale", )";
  CHECK(rule<LineConstraint>(head + R"("scale": 1.25})").scale.factor == 1.25);
  CHECK(rule<LineConstraint>(head + R"("scale_group": "g"})").scale.group == "g");
  const auto both = rule<LineConstraint>(head + R"("scale": "free", "scale_group": "g"})");
  CHECK(!both.scale.factor.has_value());
}

TEST_CASE("constraints_json: circles and arcs") {
  const auto plain = rule<CircleConstraint>(R"({"type": "circle", "feature": "ring"})");
  CHECK(plain.feature == "ring");
  CHECK(!plain.scale.factor.has_value());
  CHECK(!plain.radius.has_value());
  CHECK(!plain.sweep_degrees.has_value());
  CHECK(!plain.mirror.has_value());
  const auto arc = rule<CircleConstraint>(
      R"({"type": "circle", "feature": "a", "radius": 0.25, "sweep_degrees": 190, "mirror": false})");
  CHECK(arc.radius == 0.25);
  CHECK(arc.sweep_degrees == 190);
  CHECK(arc.mirror == false);
  CHECK(rule<CircleConstraint>(R"({"type": "circle", "feature": "a", "scale": 1})").scale.factor == 1);
}

TEST_CASE("constraints_json: angles between features and between edges") {
  const auto angle = rule<AngleConstraint>(R"({"type": "angle", "features": ["a", "b"], "degrees": 62.5})");
  CHECK(angle.features == std::vector<std::string>{"a", "b"});
  CHECK(angle.edges.empty());
  CHECK(angle.degrees == 62.5);
  CHECK(!angle.oriented);
  CHECK(!angle.measure.has_value());
  const auto edges = rule<AngleConstraint>(
      R"({"type": "angle", "edges": [[3, 8], [20, 21]], "oriented": true, "degrees": 359.5})");
  CHECK(edges.features.empty());
  CHECK(edges.edges == std::vector<std::array<Index, 2>>{{3, 8}, {20, 21}});
  CHECK(edges.degrees == 359.5);
  CHECK(edges.oriented);
  const auto parallel =
      rule<AngleConstraint>(R"({"type": "parallel", "features": ["a", "b"], "measure": "chord"})");
  CHECK(parallel.degrees == 0);
  CHECK(parallel.measure == Measure::Chord);
  const auto right = rule<AngleConstraint>(
      R"({"type": "perpendicular", "features": ["a", "b"], "measure": "line", "oriented": true})");
  CHECK(right.degrees == 90);
  CHECK(right.oriented);
  CHECK(right.measure == Measure::Line);
}

TEST_CASE("constraints_json: directions, curves, regions, pins") {
  const auto direction = rule<DirectionConstraint>(
      R"({"type": "direction", "feature": "a", "degrees": 180, "measure": "line"})");
  CHECK(direction.feature == "a");
  CHECK(!direction.edge.has_value());
  CHECK(direction.degrees == 180);
  CHECK(direction.measure == Measure::Line);
  const auto edge =
      rule<DirectionConstraint>(R"({"type": "direction", "edge": [5, 4], "degrees": 270, "oriented": true})");
  CHECK(edge.feature.empty());
  CHECK(edge.edge == std::array<Index, 2>{5, 4});
  CHECK(edge.oriented);
  const auto curve = rule<CurveConstraint>(R"({"type": "curve", "feature": "ring"})");
  CHECK(curve.scale.factor == 1);
  CHECK(curve.shape == CurveConstraint::Shape::Plane);
  const auto free = rule<CurveConstraint>(
      R"({"type": "curve", "feature": "a", "scale": "free", "shape": "geodesic", "mirror": true})");
  CHECK(!free.scale.factor.has_value());
  CHECK(free.shape == CurveConstraint::Shape::Geodesic);
  CHECK(free.mirror == true);
  const auto group = rule<CurveConstraint>(R"({"type": "curve", "feature": "a", "scale_group": "g"})");
  CHECK(!group.scale.factor.has_value());
  CHECK(group.scale.group == "g");
  CHECK(rule<RegionConstraint>(R"({"type": "region", "feature": "patch"})").scale.factor == 1);
  CHECK(rule<RegionConstraint>(R"({"type": "region", "feature": "patch", "scale": 2})").scale.factor == 2);
  const auto pin = rule<PinConstraint>(R"({"type": "pin", "vertices": [3, 0], "uv": [[0, 0.5], [-1, 2]]})");
  CHECK(pin.vertex == std::vector<Index>{3, 0});
  CHECK(pin.uv == std::vector<Vec2>{{0, 0.5}, {-1, 2}});
}

TEST_CASE("constraints_json: a constraint without a name is called by its type and features") {
  const auto set = must_parse(with_constraints(R"({"type": "line", "feature": "a"},
    {"type": "angle", "features": ["b", "a"], "degrees": 3}, {"name": "mine", "type": "line", "feature": "b"},
    {"type": "perpendicular", "edges": [[3, 8], [20, 21]]}, {"type": "direction", "edge": [1, 2], "degrees": 0},
    {"type": "pin", "vertices": [5], "uv": [[0, 0]]},
    {"type": "pin", "vertices": [1, 2, 3, 4, 9], "uv": [[0,0], [1,0], [2,0], [3,0], [4,0]]})"));
  std::vector<std::string> names, types;
  for (const Constraint& c : set.constraints) names.push_back(c.name), types.push_back(c.type);
  CHECK(names == std::vector<std::string>{"line a", "angle b a", "mine", "perpendicular 3-8 20-21",
                                          "direction 1-2", "pin 5", "pin 1 2 3 and 2 more"});
  CHECK(types ==
        std::vector<std::string>{"line", "angle", "line", "perpendicular", "direction", "pin", "pin"});
}

TEST_CASE("constraints_json: the rest of the file, and its defaults") {
  const auto least = must_parse(R"({"version": 1})");
  CHECK(least.agreement == 1e-3);
  CHECK(least.outer.empty());
  CHECK(least.features.empty());
  CHECK(least.constraints.empty());
  CHECK(least.seams.empty());
  const auto set = must_parse(R"({"seams": ["q", "p"], "outer": "p", "agreement": 0, "$schema": "x",
    "features": {"p": {"loop": 0}, "q": {"loop": 1}}, "version": 1})");
  CHECK(set.agreement == 0);
  CHECK(set.outer == "p");
  CHECK(set.seams == std::vector<std::string>{"q", "p"});
}

TEST_CASE("constraints_json: text that is no JSON has line, column and pointer") {
  const auto set =
      parse("{\"version\": 1,\n \"features\": {\"a\": {\"polyline\":\n [[0, 1, 2], [3, NaN, 5]]}}}");
  REQUIRE(!set.has_value());
  CHECK(set.error().code == ErrorCode::BadSyntax);
  CHECK(set.error().place.line == 3);
  CHECK(set.error().place.column == 18);
  CHECK(set.error().place.pointer == "/features/a/polyline/1/1");
  CHECK(set.error().what.find("JSON has neither NaN nor infinity") != std::string::npos);
  CHECK(describe(set.error()).starts_with("c.json:3:18: /features/a/polyline/1/1: not valid JSON: "));
  check_wrong({{"", "", "not valid JSON"},
               {"{\"version\": 1", "", "not valid JSON"},
               {"{\"version\": }", "/version", "not valid JSON"},
               {"{\"agreement\": -Infinity}", "/agreement", "neither NaN nor infinity"},
               {"{\"agreement\": 1e400}", "/agreement", "1e400"},
               {"{\"seams\": [\"a\", \"b\",]}", "/seams/2", "not valid JSON"},
               {"{\"version\": 1} x", "", "not valid JSON"},
               {"{\"outer\": \"\xff\"}", "/outer", "UTF-8"}});
}

TEST_CASE("constraints_json: a name that stands twice in an object is refused wherever it is") {
  check_wrong({{R"({"version": 1, "version": 1})", "/version", "'version' stands twice"},
               {R"({"version": 1, "features": {"a/b": {"loop": 0}, "c": {"loop": 2}, "a/b": {"loop": 1}}})",
                "/features/a~1b", "'a/b' stands twice"},
               {with_constraints(R"({"type": "line", "feature": "a"}, {"type": "line", "type": "line"})"),
                "/constraints/1/type", "'type' stands twice"}});
}

TEST_CASE("constraints_json: unknown words are answered with the nearest known one") {
  check_wrong({
      {R"({"version": 1, "feature": {}})", "/feature",
       "unknown key 'feature', the nearest known one is 'features'"},
      {with_feature(R"({"polylin": [[0,0,0]]})"), "/features/x/polylin", "nearest known one is 'polyline'"},
      {with_feature(R"({"loop": 1, "closd": true})"), "/features/x/closd", "nearest known one is 'loop'"},
      {with_feature(R"({"vertices": [1, 2], "jion": "shortest"})"), "/features/x/jion", "is 'join'"},
      {with_feature(R"({"vertices": [1, 2], "join": "shortst"})"), "/features/x/join", "is 'shortest'"},
      {with_feature(R"({"sharp_edges": {"degree": 3, "near": [0,0,0]}})"), "/features/x/sharp_edges/degree",
       "is 'degrees'"},
      {with_constraints(R"({"type": "lines", "feature": "a"})"), "/constraints/0/type", "is 'line'"},
      {with_constraints(R"({"type": "line", "feature": "a"}, {"type": "line", "feature": "rnig"})"),
       "/constraints/1/feature", "unknown feature 'rnig', the nearest known one is 'ring'"},
      {with_constraints(R"({"type": "parallel", "features": ["a", "pach"]})"), "/constraints/0/features/1",
       "is 'patch'"},
      {with_constraints(R"({"type": "line", "feature": "a", "oriented": true})"), "/constraints/0/oriented",
       "unknown key 'oriented'"},
      {with_constraints(R"({"type": "line", "feature": "a", "lengths": "kept"})"), "/constraints/0/lengths",
       "'keep'"},
      {R"({"version": 1, "features": {"rim": {"loop": 0}}, "outer": "rin"})", "/outer", "is 'rim'"},
      {R"({"version": 1, "features": {"rim": {"loop": 0}}, "seams": ["rim", "rom"]})", "/seams/1",
       "is 'rim'"},
      {R"({"version": 1, "features": {"in": {"enclosed_by": "inn"}}})", "/features/in/enclosed_by",
       "is 'in'"},
      {R"({"version": 1, "outer": "rim"})", "/outer", "unknown feature 'rim', there are none"},
  });
}

TEST_CASE("constraints_json: wrong types and values out of range name their place") {
  check_wrong({
      {"[]", "", "expected an object, found an array of 0"},
      {"{}", "", "'version' is missing"},
      {R"({"version": 2})", "/version", "version 1, found the number 2"},
      {R"({"version": 1, "agreement": -0.5})", "/agreement", "found -0.5"},
      {R"({"version": 1, "features": []})", "/features", "found an array of 0"},
      {R"({"version": 1, "features": {"": {"loop": 0}}})", "/features/", "empty"},
      {R"({"version": 1, "features": {"a\nb": {"loop": 0}}})", "/features/a\nb", "control character"},
      {with_feature("3"), "/features/x", "found the number 3"},
      {with_feature("{}"), "/features/x", "needs one of 'polyline'"},
      {with_feature(R"({"loop": 0, "triangles": [1]})"), "/features/x", "both 'loop' and 'triangles'"},
      {with_feature(R"({"polyline": []})"), "/features/x/polyline", "empty"},
      {with_feature(R"({"polyline": [[0, 0, 0], [1, 2]]})"), "/features/x/polyline/1", "found an array of 2"},
      {with_feature(R"({"polyline": [[0, 0, 0], [1, null, 2]]})"), "/features/x/polyline/1/1", "found null"},
      {with_feature(R"({"polyline": [[0, 0, 0]], "max_distance": 0})"), "/features/x/max_distance",
       "positive"},
      {with_feature(R"({"polyline": [[0, 0, 0]], "closed": 1})"), "/features/x/closed", "true or false"},
      {with_feature(R"({"vertices": [1, -1]})"), "/features/x/vertices/1", "found -1"},
      {with_feature(R"({"vertices": [1, 2.5]})"), "/features/x/vertices/1", "found 2.5"},
      {with_feature(R"({"triangles": [2147483648]})"), "/features/x/triangles/0", "from 0 to 2147483647"},
      {with_feature(R"({"loop": "0"})"), "/features/x/loop", "found the string '0'"},
      {with_feature(R"({"plane_cut": {"point": [0,0,0], "normal": [0,0,1]}})"), "/features/x/plane_cut",
       "'near' is missing"},
      {with_feature(R"({"plane_cut": {"point": [0,0,0], "normal": [0,0,0], "near": [0,0,0]}})"),
       "/features/x/plane_cut/normal", "zero"},
      {with_feature(R"({"sharp_edges": {"near": [0,0,0], "degrees": 180}})"),
       "/features/x/sharp_edges/degrees", "between 0 and 180"},
  });
}

TEST_CASE("constraints_json: options that do not fit each other name their place") {
  const auto at = [](const std::string& constraint, const std::string& pointer, const std::string& message) {
    return Wrong{with_constraints(constraint), "/constraints/0" + pointer, message};
  };
  check_wrong({
      at(R"({"feature": "a"})", "", "'type' is missing"),
      at(R"({"type": "line"})", "", "'feature' is missing"),
      at(R"({"type": "line", "feature": "a", "scale": 2})", "/scale", "needs 'lengths': 'scale'"),
      at(R"({"type": "line", "feature": "a", "lengths": "free", "scale_group": "g"})", "/scale_group",
         "needs 'lengths': 'scale'"),
      at(R"({"type": "curve", "feature": "a", "scale": "fre"})", "/scale", "a positive number or 'free'"),
      at(R"({"type": "curve", "feature": "a", "scale": -1})", "/scale", "positive"),
      at(R"({"type": "curve", "feature": "a", "scale": 1, "scale_group": "g"})", "/scale_group",
         "free scale"),
      at(R"({"type": "circle", "feature": "a", "radius": 1, "scale": 1})", "/scale", "beside 'radius'"),
      at(R"({"type": "circle", "feature": "a", "sweep_degrees": 360})", "/sweep_degrees", "found 360"),
      at(R"({"type": "angle", "features": ["a", "b"]})", "", "'degrees' is missing"),
      at(R"({"type": "angle", "features": ["a", "b"], "degrees": 181})", "/degrees", "from 0 to 180"),
      at(R"({"type": "angle", "features": ["a", "b"], "degrees": 360, "oriented": true})", "/degrees",
         "below 360"),
      at(R"({"type": "angle", "degrees": 1})", "", "needs 'features' or 'edges'"),
      at(R"({"type": "parallel", "features": ["a"]})", "/features", "two features, found an array of 1"),
      at(R"({"type": "parallel", "features": ["a", "a"]})", "/features", "'a' twice"),
      at(R"({"type": "parallel", "features": ["a", "b"], "edges": [[0,1],[2,3]]})", "/features",
         "beside 'edges'"),
      at(R"({"type": "parallel", "edges": [[0,1],[2,3]], "measure": "line"})", "/measure", "beside 'edges'"),
      at(R"({"type": "parallel", "edges": [[0,1],[2,2]]})", "/edges/1", "two different vertices"),
      at(R"({"type": "parallel", "edges": [[0,1],[2]]})", "/edges/1", "found an array of 1"),
      at(R"({"type": "direction", "degrees": 1})", "", "needs 'feature' or 'edge'"),
      at(R"({"type": "direction", "degrees": 1, "feature": "a", "edge": [0, 1]})", "/feature",
         "beside 'edge'"),
      at(R"({"type": "pin", "vertices": [0, 1], "uv": [[0, 0]]})", "/uv", "each of the 2 vertices, found 1"),
      at(R"({"type": "pin", "vertices": [0, 4, 0], "uv": [[0,0],[1,1],[2,2]]})", "/vertices",
         "vertex 0 stands twice"),
      at(R"({"type": "line", "feature": "a", "name": ""})", "/name", "empty"),
  });
  check_wrong(
      {{with_constraints(R"({"type": "line", "feature": "a"}, {"type": "line", "feature": "a"})"),
        "/constraints/1", "two constraints are called 'line a'"},
       {with_constraints(
            R"({"type": "line", "feature": "b", "name": "n"}, {"type": "line", "feature": "a", "name": "n"})"),
        "/constraints/1", "two constraints are called 'n'"}});
}

TEST_CASE("constraints_json: a region is no curve, and a curve no region") {
  check_wrong(
      {{with_constraints(R"({"type": "line", "feature": "patch"})"), "/constraints/0/feature", "is a region"},
       {with_constraints(R"({"type": "region", "feature": "a"})"), "/constraints/0/feature", "is a curve"},
       {R"({"version": 1, "features": {"in": {"enclosed_by": "in"}}})", "/features/in/enclosed_by",
        "is a region"}},
      ErrorCode::ConstraintInvalid);
}

TEST_CASE("constraints_json: polyline files are found beside the constraint file") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  REQUIRE(write_file(folder / "sub/crease.csv", "x,y,z\n0,0,0\n1,0,0.25\n"));
  REQUIRE(write_file(folder / "sub/c.json",
                     R"({"version": 1, "features": {"cad": {"file": "crease.csv", "max_distance": 2},
                         "shut": {"file": "./crease.csv", "closed": true}}})"));
  const auto set = read_constraints(Exec(), folder / "sub/c.json");
  if (!set) FAIL(describe(set.error()));
  const auto cad = std::get<PolylineSource>(set->features[0].source);
  CHECK(cad.point == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0.25}});
  CHECK(!cad.closed);
  CHECK(cad.max_distance == 2);
  CHECK(std::get<PolylineSource>(set->features[1].source).closed);
}

TEST_CASE("constraints_json: a fault in a polyline file names the feature, the file and its line") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder / "bad.csv", "0 0 0\n1 nan 0\n"));
  REQUIRE(write_file(folder / "ring.csv", "0 0 0\n1 0 0\n0 1 0\n0 0 0\n"));
  const auto bad = parse(R"({"version": 1, "features": {"cad": {"file": "bad.csv"}}})", folder / "");
  REQUIRE(!bad.has_value());
  CHECK(bad.error().code == ErrorCode::BadSyntax);
  CHECK(bad.error().place.file == folder / "bad.csv");
  CHECK(bad.error().place.line == 2);
  CHECK(bad.error().what == "feature 'cad': a coordinate is not a finite number");
  const auto none = parse(R"({"version": 1, "features": {"cad": {"file": "none.csv"}}})", folder / "");
  REQUIRE(!none.has_value());
  CHECK(none.error().code == ErrorCode::CannotOpen);
  CHECK(none.error().place.pointer == "/features/cad/file");
  CHECK(none.error().what.find("none.csv") != std::string::npos);
  const auto open =
      parse(R"({"version": 1, "features": {"cad": {"file": "ring.csv", "closed": false}}})", folder / "");
  REQUIRE(!open.has_value());
  CHECK(open.error().place.pointer == "/features/cad/closed");
}

TEST_CASE("constraints_json: a file that is not there cannot be opened") {
  const TemporaryFolder folder;
  const auto set = read_constraints(Exec(), folder / "none.json");
  REQUIRE(!set.has_value());
  CHECK(set.error().code == ErrorCode::CannotOpen);
}

TEST_CASE("constraints_json: no prefix and no changed byte of a good file does harm") {
  const std::string good = with_constraints(
      R"({"type": "line", "feature": "a", "lengths": "scale", "scale_group": "g"},
         {"type": "angle", "edges": [[3, 8], [20, 21]], "degrees": 30, "oriented": true},
         {"type": "pin", "vertices": [3], "uv": [[0, 0]]})");
  must_parse(good);
  for (std::size_t size = 0; size < good.size(); ++size) CHECK(!parse(good.substr(0, size)).has_value());
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const char c : {'"', '{', ']', ',', '-', '\0', '\xc3'}) {
      std::string changed = good;
      changed[i] = c;
      if (const auto set = parse(changed); !set) CHECK(describe(set.error()).starts_with("c.json"));
    }
  }
}

TEST_CASE("constraints_json: deep nesting is refused, not followed into the ground") {
  const auto set = parse(R"({"version": 1, "features": )" + std::string(1 << 20, '['));
  REQUIRE(!set.has_value());
  CHECK(set.error().code == ErrorCode::BadSyntax);
}

TEST_CASE("json_document: every value has the pointer that leads to it") {
  const std::string text = R"({"a": [1, {"b/c": [true, null]}, []], "~": {"": "s"}})";
  const auto document = JsonDocument::parse(text, "f");
  REQUIRE(document.has_value());
  std::vector<std::string> pointers;
  const auto visit = [&](const auto& self, const JsonValue& value) -> void {
    pointers.push_back(value.pointer());
    if (value.kind() == JsonKind::Array) value.for_each_element([&](const JsonValue& e) { self(self, e); });
    if (value.kind() == JsonKind::Object)
      value.for_each_member([&](const std::string&, const JsonValue& m) { self(self, m); });
  };
  visit(visit, document->root());
  CHECK(pointers == std::vector<std::string>{"", "/a", "/a/0", "/a/1", "/a/1/b~1c", "/a/1/b~1c/0",
                                             "/a/1/b~1c/1", "/a/2", "/~0", "/~0/"});
}

TEST_CASE("constraints_json: the documented examples are read") {
  const auto blocks = fenced_json(PLANISH_DOCS "/constraints.md");
  CHECK(blocks.size() > 15);
  for (const std::string& block : blocks) {
    CAPTURE(block);
    std::string text = block;
    if (block.find("\"type\"") != std::string::npos && block.find("\"version\"") == std::string::npos) {
      text = R"({"version": 1, "features": {"sill": {"loop": 0}, "edge": {"loop": 1}, "arch": {"loop": 2},
        "window": {"loop": 3}, "patch": {"triangles": [1]}}, "constraints": [)" +
             block + "]}";
    } else if (block.find("\"version\"") == std::string::npos) {
      text = R"({"version": 1, "features": {"arch": {"loop": 0}, "x": )" + block + "}}";
    }
    const auto set = parse(text);
    if (!set) FAIL_CHECK(describe(set.error()));
  }
}

TEST_CASE("constraints_json: the files of real parts are read") {
  const std::string folder = PLANISH_SHARED_DATA;
  if (!std::filesystem::exists(folder)) {
    MESSAGE("left out: no ", folder);
    return;
  }
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".constraints.json")) continue;
    CAPTURE(path);
    const auto set = read_constraints(Exec(), path);
    if (!set) FAIL_CHECK(describe(set.error()));
    CHECK((!set || (!set->features.empty() && !set->constraints.empty())));
    ++count;
  }
  CHECK(count > 0);
}
