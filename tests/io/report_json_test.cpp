#include "io/report_json.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <set>
#include <nlohmann/json.hpp>

namespace planish {
namespace {

using nlohmann::json;

Spread spread(double x) { return {x, x + 1, x + 0.5, x + 0.1, x + 0.4, x + 0.9}; }

Flattening example() {
  Flattening f;
  f.mesh = {.vertices = 12,
            .unreferenced_vertices = 1,
            .triangles = 9,
            .components = 2,
            .boundary_loops = 3,
            .euler = 1,
            .outer = {0, 2},
            .mollified_triangles = 4};
  f.certificate.arap = 0.1 + 0.2;
  f.certificate.symmetric_dirichlet = kInfinity;
  f.certificate.sigma_max = spread(1.1);
  f.certificate.sigma_min = spread(-0.3);
  f.certificate.area_ratio = spread(0.7);
  f.certificate.angle_distortion = spread(2.2);
  f.certificate.flipped_triangles = 100;
  for (Index t = 0; t < 100; ++t) f.certificate.flipped.push_back(3 * t);
  f.certificate.overwound_vertices = 1;
  f.certificate.overwound = {5};
  f.certificate.overlapping_pairs = 7;
  f.certificate.overlap_area_fraction = 1e-3 / 3;
  f.certificate.benchmark = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, kInfinity, 0.8, 0.1 + 0.2};
  f.history = {{0, 0.5, 0}, {1, 0.25, 1e-3}};
  f.iterations = 1;
  f.converged = true;
  f.gradient = std::nan("");
  f.holonomy_residual = 5e-324;
  f.timings = {{"check", 0.125}, {"write", 0.25}};
  f.threads = 2;
  return f;
}

/// Of each kind one: a line, a direction of an edge, an angle of features, a pin.
Flattening constrained() {
  Flattening f = example();
  f.up_to_scale = {"straight sill"};
  f.intrinsic = {.moved_edges = 12, .angle_defect = 1e-13 / 3};
  f.constraints = {.outcome = {},
                   .bodies = 3,
                   .assemblies = 2,
                   .clusters = 1,
                   .border_unknowns = 4,
                   .factor_nonzeros = 1LL << 33};
  f.constraints.outcome = {{.name = "straight sill",
                            .type = "line",
                            .features = {"sill"},
                            .side = 2,
                            .residual = 1e-16 / 3,
                            .residual_abs = 1e-15,
                            .scale = 0.1 + 0.2,
                            .orientation = -90,
                            .shape = {{-0.5, 0}, {0.5, 0}},
                            .mirrored = false,
                            .chirality_open = true,
                            .planarity = 0.25,
                            .yielded_to = "round",
                            .mismatch = 1e-9,
                            .yielded = {4, 6}},
                           {.name = "d", .type = "direction", .edges = {{7, 8}}, .degrees = 45.0},
                           {.name = "a", .type = "angle", .features = {"sill", "rim"}, .degrees = 30.0},
                           {.name = "pin 3", .type = "pin", .pinned = {3}, .residual = 0.5}};
  return f;
}

ReportContext context() {
  return {.input = "part.obj",
          .command = "planish flatten part.obj",
          .mendings = {{"turned triangles", 47, {1, 2}}},
          .warnings = {"a warning"},
          .extra_timings = {{"read", 0.5}, {"write", 0.5}},
          .peak_memory_bytes = 1LL << 40};
}

ReportContext context_with_peaks() {
  ReportContext with_peaks = context();
  with_peaks.peaks = {{"read", 1000}, {"local_global", 1LL << 40}};
  return with_peaks;
}

json report() { return json::parse(report_json(example(), context())); }

std::set<std::string> keys(const json& object) {
  std::set<std::string> names;
  for (const auto& [key, value] : object.items()) names.insert(key);
  return names;
}

/// The schema's properties, all of them required, are exactly the object's keys.
void check_keys(const json& schema, const json& object) {
  CHECK(keys(schema["properties"]) == keys(object));
  CHECK(schema["required"].get<std::set<std::string>>() == keys(object));
  CHECK(schema["additionalProperties"] == false);
}

json schema(const char* name) {
  std::ifstream file(std::string(PLANISH_DOCS) + "/" + name);
  REQUIRE(file);
  return json::parse(file);
}

Embedding embedding() {
  Embedding e;
  e.position.resize(7);
  e.corner_vertex.resize(15);
  e.triangle_origin = {0, 1, 1, 2, 0};
  e.vertex_origin.resize(2);
  e.snapped_points = 3;
  e.feasibility_splits = 1;
  e.features = {{"sill", {4, 5, 6}, false, 0.1 + 0.2, 1e-3 / 3, {}},
                {"rim", {0, 1, 2}, true, 3, 0, {}},
                {"plate", {}, false, 0, 0, {1, 4}}};
  return e;
}

constexpr CutFacts kCut = {.cut_edges = 12, .cut_length = 3.5, .charts = 2};

std::set<std::string> required(const json& schema) { return schema["required"].get<std::set<std::string>>(); }

/// Keys that stand in all reports and in those of `kind`, as the schema has them.
std::set<std::string> required_of(const json& schema, const char* kind) {
  std::set<std::string> names = required(schema);
  names.merge(required(schema["$defs"][kind]));
  return names;
}

Diagnosis diagnosis() {
  Diagnosis d;
  d.vertices = 5;
  d.triangles = 3;
  d.genus = kNone;
  d.loop_lengths = {3.5, 1.25};
  d.upper = {1, 2, 3};
  d.defects = {{ErrorCode::NonManifoldEdge, ElementKind::Edge, {3, 8}, 1}};
  return d;
}

TEST_CASE("report_json: numbers read back bit for bit") {
  const json r = report();
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  CHECK(bits(r["energy"]["arap"]) == bits(0.1 + 0.2));
  CHECK(bits(r["overlap_area_fraction"]) == bits(1e-3 / 3));
  CHECK(bits(r["benchmark"]["max_area_distortion"]) == bits(0.1));
  CHECK(bits(r["benchmark"]["average_area_error"]) == bits(0.2));
  CHECK(bits(r["benchmark"]["min_singular_value"]) == bits(0.3));
  CHECK(bits(r["benchmark"]["max_singular_value"]) == bits(0.4));
  CHECK(bits(r["benchmark"]["proportion_flipped_triangles"]) == bits(0.5));
  CHECK(bits(r["benchmark"]["bijectivity_violation_area"]) == bits(0.6));
  CHECK(r["benchmark"]["max_angle_distortion"].is_null());
  CHECK(bits(r["benchmark"]["average_angle_error"]) == bits(0.8));
  CHECK(bits(r["benchmark"]["resolution"]) == bits(0.1 + 0.2));
  CHECK(bits(r["holonomy_residual"]) == bits(5e-324));
  CHECK(bits(r["stretch"]["sigma_min"]["p99"]) == bits(-0.3 + 0.9));
  CHECK(r["peak_memory_bytes"] == 1LL << 40);
}

TEST_CASE("report_json: peaks of steps are there where they were taken") {
  const json r = json::parse(report_json(example(), context_with_peaks()));
  CHECK(r["peak_memory_by_step_bytes"] == json{{"read", 1000}, {"local_global", 1LL << 40}});
  CHECK_FALSE(report().contains("peak_memory_by_step_bytes"));
}

TEST_CASE("report_json: infinite and undefined numbers are null") {
  const json r = report();
  CHECK(r["energy"]["symmetric_dirichlet"].is_null());
  CHECK(r["gradient"].is_null());
}

TEST_CASE("report_json: the report has the fields of its schema and no others") {
  const json s = schema("report.schema.json"), r = report();
  CHECK(required_of(s, "flatten") == keys(r));
  for (const std::string& name : keys(r)) CHECK(s["properties"].contains(name));
  CHECK(s["additionalProperties"] == false);
  for (const char* part : {"mesh", "energy", "stretch"}) check_keys(s["properties"][part], r[part]);
  for (const char* quantity : {"sigma_max", "sigma_min", "area_ratio", "angle_distortion"}) {
    check_keys(s["$defs"]["spread"], r["stretch"][quantity]);
  }
  for (const char* list : {"history", "repairs"}) check_keys(s["properties"][list]["items"], r[list][0]);
}

const Price kPrice{.energy = 0.75,
                   .unconstrained = 0.125,
                   .without_refit = 0.8,
                   .constraints = {{"straight", 0.25, 0.5}, {"angle", 0, 0, "no line"}}};

const DeformFacts kDeformed{.reference = Reference::Parameterization,
                            .steps = 7,
                            .way = {{.step = 0, .arap = 0.5, .flipped = 3, .overwound = 1},
                                    {.step = 1, .arap = 0.75, .flipped = 0, .overwound = 2}},
                            .poses = FeaturePoses::Free,
                            .map_scale = 2.5,
                            .mirrored = 1,
                            .release = Release::Features,
                            .given_arap = 0.5,
                            .given_flipped = 3,
                            .largest_displacement = 0.25,
                            .mean_displacement = 0.125};

TEST_CASE(
    "report_json: with features, constraints, prices, peaks, a deformation and a cut the report has all "
    "fields of "
    "its schema") {
  const Embedding e = embedding();
  const json s = schema("report.schema.json"),
             r = json::parse(
                 report_json(constrained(), context_with_peaks(),
                             {.embedding = &e, .cut = &kCut, .price = &kPrice, .deformation = &kDeformed}));
  CHECK(keys(r) == keys(s["properties"]));
  check_keys(s["properties"]["deformation"], r["deformation"]);
  CHECK(r["deformation"]["reference"] == "parameterization");
  CHECK(r["deformation"]["release"] == "features");
  CHECK(r["deformation"]["largest_displacement"] == 0.25);
  CHECK(r["deformation"]["poses"] == "free");
  CHECK(r["deformation"]["way"][1] ==
        json({{"step", 1}, {"arap", 0.75}, {"flipped_triangles", 0}, {"overwound_vertices", 2}}));
  check_keys(s["properties"]["price"], r["price"]);
  CHECK(r["price"]["constraints"][0] ==
        json({{"name", "straight"}, {"energy_without", 0.25}, {"cost", 0.5}}));
  CHECK(r["price"]["constraints"][1]["energy_without"].is_null());
  CHECK(r["price"]["constraints"][1]["reason"] == "no line");
  for (const char* part : {"embedding", "refinement", "cut", "elimination"})
    check_keys(s["properties"][part], r[part]);
  check_keys(s["$defs"]["chain"], r["features"]["sill"]);
  check_keys(s["$defs"]["region"], r["features"]["plate"]);
}

TEST_CASE("report_json: constraints have the fields of their kind in the schema") {
  const json s = schema("report.schema.json")["$defs"],
             r = json::parse(report_json(constrained(), context()));
  const auto is_of = [&](const json& entry, const char* kind) {
    CHECK(s[kind]["additionalProperties"] == false);
    for (const std::string& name : required(s[kind])) CHECK_MESSAGE(entry.contains(name), name);
    for (const std::string& name : keys(entry)) CHECK_MESSAGE(s[kind]["properties"].contains(name), name);
  };
  const json& entries = r["constraints"];
  REQUIRE(entries.size() == 4);
  is_of(entries[0], "shaped");
  CHECK(keys(entries[0]) == keys(s["shaped"]["properties"]));
  CHECK(entries[0]["scale"] == 0.1 + 0.2);
  CHECK(entries[0]["residual"] == 1e-16 / 3);
  CHECK(entries[0]["template"] == json({{-0.5, 0.0}, {0.5, 0.0}}));
  CHECK(entries[0]["side"] == 2);
  is_of(entries[1], "relation");
  CHECK(entries[1]["edge"] == json({7, 8}));
  is_of(entries[2], "relation");
  CHECK(entries[2]["features"] == json({"sill", "rim"}));
  is_of(entries[3], "pin");
  CHECK(entries[3]["vertices"] == json::array({3}));
  CHECK(r["elimination"]["factor_nonzeros"] == 1LL << 33);
}

TEST_CASE("report_json: features stand under their names, in order, with their numbers bit for bit") {
  const Embedding e = embedding();
  const std::string text = report_json(example(), context(), {.embedding = &e, .cut = &kCut});
  const json r = json::parse(text);
  CHECK(r["embedding"] == json({{"vertices_added", 2}, {"triangles_added", 2}, {"snapped_points", 3}}));
  CHECK(r["refinement"] == json({{"feasibility_splits", 1}}));
  CHECK(
      r["features"]["sill"] ==
      json({{"vertices", {4, 5, 6}}, {"closed", false}, {"length", 0.1 + 0.2}, {"max_deviation", 1e-3 / 3}}));
  CHECK(r["features"]["rim"]["closed"] == true);
  CHECK(r["features"]["plate"] == json({{"triangles", {1, 4}}}));
  CHECK(r["cut"] == json({{"cut_edges", 12}, {"cut_length", 3.5}, {"charts", 2}}));
  CHECK(text.find("\"sill\"") < text.find("\"rim\""));
}

TEST_CASE("embed_report_json: the report has the fields of its kind in the schema and no others") {
  const json s = schema("report.schema.json"), r = json::parse(embed_report_json(embedding(), context()));
  CHECK(required_of(s, "embed") == keys(r));
  for (const auto& [name, value] : s["$defs"]["embed"]["properties"].items()) {
    CHECK(value == false);
    CHECK(!r.contains(name));
    const bool of_constraints = name == "constraints" || name == "elimination";
    CHECK(required(s["$defs"]["flatten"]).contains(name) != of_constraints);
  }
  const json cut = json::parse(embed_report_json(embedding(), context(), &kCut));
  CHECK(cut["cut"]["charts"] == 2);
  CHECK(cut["timings_s"] == json({{"read", 0.5}, {"write", 0.5}}));
}

TEST_CASE("embed_report_json: a mesh that needed no change has nothing added") {
  Embedding e;
  e.triangle_origin = {0, 1, 2};
  const json r = json::parse(embed_report_json(e, context()));
  CHECK(r["embedding"] == json({{"vertices_added", 0}, {"triangles_added", 0}, {"snapped_points", 0}}));
  CHECK(r["features"] == json::object());
  CHECK(json::parse(embed_report_json({}, context()))["embedding"]["triangles_added"] == 0);
}

TEST_CASE("report_json: at most 64 ids are listed beside the full count") {
  const json r = report();
  CHECK(r["flipped_triangles"] == 100);
  REQUIRE(r["flipped_ids"].size() == 64);
  CHECK(r["flipped_ids"][63] == 189);
  CHECK(r["overwound_ids"] == json::array({5}));
}

TEST_CASE("report_json: facts stand under their names") {
  const json r = report();
  CHECK(r["version"] == 1);
  CHECK(r["planish"].get<std::string>().find('.') != std::string::npos);
  CHECK(r["mesh"]["outer"] == json::array({0, 2}));
  CHECK(r["mesh"]["mollified_triangles"] == 4);
  CHECK(r["stretch"]["angle_distortion"]["mean"] == 2.2 + 0.5);
  CHECK(r["history"][1] ==
        json({{"iteration", 1}, {"energy", 0.25}, {"gradient", 1e-3}, {"phase", "local_global"}}));
  CHECK(r["timings_s"] == json({{"check", 0.125}, {"write", 0.75}, {"read", 0.5}}));  // both writes
  CHECK(r["repairs"][0] == json({{"what", "turned triangles"}, {"count", 47}, {"ids", {1, 2}}}));
  CHECK(r["warnings"] == json::array({"a warning"}));
}

TEST_CASE("report_json: paths that are not UTF-8 still give valid JSON") {
  ReportContext c = context();
  c.input = "t\xfcr.obj";
  CHECK(json::parse(report_json(example(), c))["input"] == "t\xEF\xBF\xBDr.obj");
}

Verification verification() {
  Verification v;
  v.triangles = 9;
  v.charts = 2;
  v.torn_edges = 4;
  v.certificate = example().certificate;
  v.overlapping = {{0, 3}, {1, 2}};
  v.constraints = {
      {.name = "sill", .type = "line", .side = 2, .residual = 1e-16 / 3, .allowed = 1e-9, .faults = {"off"}},
      {.name = "pin 3", .type = "pin", .allowed = 1e-9, .unmeasured = "no file"},
      {.name = "a", .type = "angle", .degrees = true, .residual = 0.5, .allowed = 1e-7}};
  v.faults = {"the report lies"};
  return v;
}

TEST_CASE("verification_json: the answer has the fields of its schema and no others") {
  const json s = schema("verify.schema.json"),
             r = json::parse(verification_json(verification(), {.mesh = "o.ply",
                                                                .report = "r.json",
                                                                .constraints = "",
                                                                .uv_set = "st",
                                                                .other_sets = {"uv"}}));
  check_keys(s, r);
  for (const char* part : {"energy", "stretch"}) check_keys(s["properties"][part], r[part]);
  check_keys(s["$defs"]["spread"], r["stretch"]["sigma_max"]);
  const json& item = s["properties"]["constraints"]["items"];
  for (const json& entry : r["constraints"]) {
    for (const std::string& name : required(item)) CHECK_MESSAGE(entry.contains(name), name);
    for (const std::string& name : keys(entry)) CHECK_MESSAGE(item["properties"].contains(name), name);
  }
  CHECK(r["holds"] == false);
  CHECK(r["constraint_file"].is_null());
  CHECK(r["energy"]["symmetric_dirichlet"].is_null());
  CHECK(r["overlapping_ids"] == json({{0, 3}, {1, 2}}));
  CHECK(r["constraints"][0]["residual"] == 1e-16 / 3);
  CHECK(r["constraints"][1]["residual"].is_null());
  CHECK(r["constraints"][1]["unmeasured"] == "no file");
  CHECK(r["constraints"][2]["unit"] == "degrees");
}

TEST_CASE("diagnosis_json: the answer has the fields of its schema and no others") {
  const json s = schema("diagnosis.schema.json"),
             d = json::parse(diagnosis_json(diagnosis(), "x.ply", {{"turned triangles", 2, {3, 4}}}, {"w"}));
  check_keys(s, d);
  check_keys(s["properties"]["defects"]["items"], d["defects"][0]);
}

TEST_CASE("diagnosis_json: defects carry code, elements and remedy") {
  const json d = json::parse(diagnosis_json(diagnosis(), "x.ply", {{"turned triangles", 2, {3, 4}}}, {"w"}));
  CHECK(d["usable"] == false);
  CHECK(d["genus"].is_null());
  CHECK(d["upper"] == json::array({1.0, 2.0, 3.0}));
  CHECK(d["loop_lengths"] == json::array({3.5, 1.25}));
  CHECK(d["defects"][0]["code"] == "non-manifold-edge");
  CHECK(d["defects"][0]["element"] == "edge");
  CHECK(d["defects"][0]["ids"] == json::array({3, 8}));
  CHECK(d["defects"][0]["remedy"] == remedy(ErrorCode::NonManifoldEdge));
}

TEST_CASE("error_json: an error keeps its place, elements and exit code; what is not known is null") {
  const Error error{
      .code = ErrorCode::BadSyntax, .what = "expected a number", .place = {"a.obj", 12, 7, kNone}};
  const json e = json::parse(error_json(error))["error"];
  CHECK(e["code"] == "bad-syntax");
  CHECK(e["exit_code"] == 3);
  CHECK(e["message"] == "expected a number");
  CHECK(e["file"] == "a.obj");
  CHECK(e["line"] == 12);
  CHECK(e["column"] == 7);
  CHECK(e["byte"].is_null());
  CHECK(e["element"] == "none");
  const Error elements{.code = ErrorCode::NonManifoldVertex,
                       .what = "w",
                       .element = ElementKind::Vertex,
                       .ids = {4},
                       .count = 90};
  const json f = json::parse(error_json(elements))["error"];
  CHECK(e["pointer"].is_null());
  const Error constraint{.code = ErrorCode::ConstraintInvalid,
                         .place = {.file = "c.json", .pointer = "/constraints/3/feature"}};
  CHECK(json::parse(error_json(constraint))["error"]["pointer"] == "/constraints/3/feature");
  CHECK(f["file"].is_null());
  CHECK(f["line"].is_null());
  CHECK(f["ids"] == json::array({4}));
  CHECK(f["count"] == 90);
  CHECK(f["remedy"] == remedy(ErrorCode::NonManifoldVertex));
}

}  // namespace
}  // namespace planish
