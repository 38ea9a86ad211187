#include "io/report_read.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "io/report_json.hpp"

using namespace planish;
using nlohmann::json;

namespace {

constexpr MeshSize kMesh = {12, 9};

Flattening flattening() {
  Flattening f;
  f.mesh = {
      .vertices = 12, .triangles = 9, .components = 2, .boundary_loops = 3, .euler = -1, .outer = {0, 2}};
  f.certificate.arap = 0.1 + 0.2;
  f.certificate.symmetric_dirichlet = kInfinity;
  f.certificate.sigma_max = {1, 2, 1.5, 1.1, 1.4, 1.9};
  f.certificate.sigma_min = {-0.3, 1, 0.5, 0.1, 0.4, 0.9};
  f.certificate.flipped_triangles = 2;
  f.certificate.flipped = {3, 8};
  f.certificate.overwound_vertices = 1;
  f.certificate.overwound = {11};
  f.certificate.overlapping_pairs = 1LL << 40;
  f.certificate.overlap_area_fraction = 1e-3 / 3;
  f.certificate.benchmark = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, kInfinity, 0.8, 0.1 + 0.2};
  f.history = {{0, 0.5, 0}};
  f.constraints.outcome = {{.name = "straight sill",
                            .type = "line",
                            .features = {"sill"},
                            .side = 2,
                            .residual = 1e-16 / 3,
                            .residual_abs = 1e-15,
                            .scale = 0.1 + 0.2,
                            .orientation = -90,
                            .shape = {{-0.5, 0}, {0.1 + 0.2, 0}},
                            .mirrored = true,
                            .planarity = 0.25,
                            .mismatch = 1e-9,
                            .yielded = {4, 6},
                            .keeps_order = false},
                           {.name = "d", .type = "direction", .edges = {{7, 8}}, .degrees = 45.0},
                           {.name = "a", .type = "angle", .features = {"sill", "rim"}, .degrees = 30.0},
                           {.name = "p", .type = "parallel", .edges = {{1, 2}, {3, 4}}, .degrees = 0.0},
                           {.name = "pin 3", .type = "pin", .pinned = {3}, .residual = 0.5},
                           {.name = "free", .type = "line", .features = {"sill"}, .orientation = 1}};
  return f;
}

Embedding embedding() {
  Embedding e;
  e.position.resize(12);
  e.corner_vertex.resize(27);
  e.triangle_origin = {0, 1, 1, 2, 0, 3, 3, 3, 3};
  e.features = {{"sill", {4, 5, 6}, false, 0.1 + 0.2, 1e-3, {}},
                {"rim", {0, 1, 2}, true, 3, 0, {}},
                {"plate", {}, false, 0, 0, {1, 8}}};
  return e;
}

std::string report() {
  const Embedding e = embedding();
  return report_json(flattening(), ReportContext(), {.embedding = &e});
}

Claims must_parse(const std::string& text, MeshSize mesh = kMesh) {
  const auto claims = parse_report(text, "r.json", mesh);
  REQUIRE_MESSAGE(claims, describe(claims.error()));
  return *claims;
}

/// The report with one value replaced is refused with this place and these words.
void check_refused(const char* pointer, const json& value, ErrorCode code, const std::string& words) {
  CAPTURE(pointer);
  json changed = json::parse(report());
  changed[json::json_pointer(pointer)] = value;
  const auto claims = parse_report(changed.dump(), "r.json", kMesh);
  REQUIRE(!claims);
  CHECK(claims.error().code == code);
  CHECK(claims.error().place.file == "r.json");
  CHECK(claims.error().place.pointer == pointer);
  CHECK_MESSAGE(claims.error().what.find(words) != std::string::npos, claims.error().what);
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

}  // namespace

TEST_CASE("report_read: what report_json writes comes back bit for bit") {
  const Claims claims = must_parse(report());
  const Flattening f = flattening();
  CHECK(claims.mesh.vertices == 12);
  CHECK(claims.mesh.components == 2);
  CHECK(claims.mesh.boundary_loops == 3);
  CHECK(claims.mesh.euler == -1);
  CHECK(!claims.cut_edges);
  CHECK(same_bits(claims.certificate.arap, f.certificate.arap));
  CHECK(claims.certificate.symmetric_dirichlet == kInfinity);
  CHECK(same_bits(claims.certificate.sigma_max.p99, 1.9));
  CHECK(claims.certificate.sigma_min.min == -0.3);
  CHECK(claims.certificate.flipped == f.certificate.flipped);
  CHECK(claims.certificate.overwound == f.certificate.overwound);
  CHECK(claims.certificate.overlapping_pairs == 1LL << 40);
  CHECK(same_bits(claims.certificate.overlap_area_fraction, f.certificate.overlap_area_fraction));
  const BenchmarkFigures &read = claims.certificate.benchmark, &written = f.certificate.benchmark;
  CHECK(same_bits(read.max_area_distortion, written.max_area_distortion));
  CHECK(same_bits(read.average_area_error, written.average_area_error));
  CHECK(same_bits(read.min_singular_value, written.min_singular_value));
  CHECK(same_bits(read.max_singular_value, written.max_singular_value));
  CHECK(same_bits(read.proportion_flipped_triangles, written.proportion_flipped_triangles));
  CHECK(same_bits(read.bijectivity_violation_area, written.bijectivity_violation_area));
  CHECK(read.max_angle_distortion == kInfinity);
  CHECK(same_bits(read.average_angle_error, written.average_angle_error));
  CHECK(same_bits(read.resolution, written.resolution));
}

TEST_CASE("report_read: features come back with their chains and triangles") {
  const Claims claims = must_parse(report());
  REQUIRE(claims.features.size() == 3);
  CHECK(claims.features[0].name == "sill");
  CHECK(claims.features[0].vertex == std::vector<Index>{4, 5, 6});
  CHECK(!claims.features[0].closed);
  CHECK(same_bits(claims.features[0].length, 0.1 + 0.2));
  CHECK(claims.features[1].closed);
  CHECK(claims.features[2].is_region());
  CHECK(claims.features[2].triangle == std::vector<Index>{1, 8});
}

TEST_CASE("report_read: constraints come back with what their kind has") {
  const Claims claims = must_parse(report());
  const auto expected = flattening().constraints.outcome;
  REQUIRE(claims.constraints.size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const ConstraintOutcome &found = claims.constraints[k], &wanted = expected[k];
    CAPTURE(wanted.name);
    CHECK(found.name == wanted.name);
    CHECK(found.type == wanted.type);
    CHECK(found.features == wanted.features);
    CHECK(found.edges == wanted.edges);
    CHECK(found.pinned == wanted.pinned);
    CHECK(found.side == wanted.side);
    CHECK(same_bits(found.residual, wanted.residual));
    CHECK(found.degrees == wanted.degrees);
    CHECK(found.scale == wanted.scale);
    CHECK(found.orientation == wanted.orientation);
    CHECK(found.shape == wanted.shape);
    CHECK(found.mirrored == wanted.mirrored);
    CHECK(found.planarity == wanted.planarity);
    CHECK(found.yielded == wanted.yielded);
    CHECK(found.keeps_order == wanted.keeps_order);
  }
}

TEST_CASE("report_read: of a cut mesh the report counts copies, so it may have more vertices") {
  Flattening f = flattening();
  f.mesh.vertices = 15;
  const CutFacts cut = {.cut_edges = 4, .cut_length = 1, .charts = 2};
  CHECK(must_parse(report_json(f, {}, {.cut = &cut})).cut_edges == 4);
  CHECK(parse_report(report_json(f, {}), "r.json", kMesh).error().code == ErrorCode::ReportOfOtherMesh);
  f.mesh.vertices = 11;
  CHECK(parse_report(report_json(f, {}, {.cut = &cut}), "r.json", kMesh).error().code ==
        ErrorCode::ReportOfOtherMesh);
}

TEST_CASE("report_read: a report of another mesh, version or command is refused with the place") {
  check_refused("/mesh/triangles", 10, ErrorCode::ReportOfOtherMesh,
                "the report is of a mesh with 10 triangles, this one has 9");
  check_refused("/mesh/vertices", 11, ErrorCode::ReportOfOtherMesh, "11 vertices, this one has 12");
  check_refused("/version", 2, ErrorCode::BadSyntax, "this program reads version 1, found the number 2");
  const auto embed = parse_report(embed_report_json(embedding(), {}), "r.json", kMesh);
  REQUIRE(!embed);
  CHECK(embed.error().what == "this is a report of embed, which has no map; give one of flatten");
}

TEST_CASE("report_read: ids that the mesh does not have are refused with the place") {
  check_refused("/features/sill/vertices/1", 12, ErrorCode::IndexOutOfRange,
                "the report names vertex 12, the mesh has 12");
  check_refused("/features/plate/triangles/0", 9, ErrorCode::IndexOutOfRange, "triangle 9, the mesh has 9");
  check_refused("/flipped_ids/1", 9, ErrorCode::IndexOutOfRange, "triangle 9");
  check_refused("/overwound_ids/0", 12, ErrorCode::IndexOutOfRange, "vertex 12");
  check_refused("/constraints/0/yielded/0", 99, ErrorCode::IndexOutOfRange, "vertex 99");
  check_refused("/constraints/1/edge/1", 12, ErrorCode::IndexOutOfRange, "vertex 12");
  check_refused("/constraints/4/vertices/0", 12, ErrorCode::IndexOutOfRange, "vertex 12");
}

TEST_CASE("report_read: values of another type are refused with the place") {
  check_refused("/energy/arap", "low", ErrorCode::BadSyntax, "expected a number");
  check_refused("/stretch/sigma_max/min", "low", ErrorCode::BadSyntax, "expected a number");
  check_refused("/features", 1, ErrorCode::BadSyntax, "expected an object of features, found the number 1");
  check_refused("/features/sill/vertices", json::array({4}), ErrorCode::BadSyntax, "a chain of two vertices");
  check_refused("/features/rim/closed", 0, ErrorCode::BadSyntax, "expected true or false");
  check_refused("/constraints", 1, ErrorCode::BadSyntax, "expected an array of constraints");
  check_refused("/constraints/0/type", "lin", ErrorCode::BadSyntax, "nearest known one is 'line'");
  check_refused("/constraints/0/template/1", json::array({1}), ErrorCode::BadSyntax, "a point of 2 numbers");
  check_refused("/constraints/0/side", 3, ErrorCode::BadSyntax, "expected the side 1 or 2");
  check_refused("/constraints/0/yielded/0", 0.5, ErrorCode::BadSyntax, "expected an index");
  check_refused("/mesh", 3, ErrorCode::BadSyntax, "expected an object");
}

TEST_CASE("report_read: missing keys are named, at every place where one is needed") {
  for (const char* key : {"version", "mesh", "energy", "stretch", "flipped_triangles", "overwound_ids",
                          "overlapping_pairs", "overlap_area_fraction", "benchmark"}) {
    CAPTURE(key);
    json changed = json::parse(report());
    changed.erase(key);
    if (key == std::string("energy")) changed.erase("embedding");
    const auto claims = parse_report(changed.dump(), "r.json", kMesh);
    REQUIRE(!claims);
    CHECK(claims.error().what == "'" + std::string(key) + "' is missing");
  }
}

TEST_CASE("report_read: text that is no JSON is refused with line and column, whatever is cut off") {
  const std::string whole = report();
  for (std::size_t length = 0; length < whole.size(); length += 97) {
    const auto claims = parse_report(whole.substr(0, length), "r.json", kMesh);
    REQUIRE(!claims);
    CHECK(claims.error().place.file == "r.json");
  }
  const auto broken = parse_report("{\"version\": 1,\n nonsense}", "r.json", kMesh);
  REQUIRE(!broken);
  CHECK(broken.error().place.line == 2);
}

TEST_CASE("report_read: a file that is not there is said") {
  const auto claims = read_report(Exec(1), "/nowhere/r.json", kMesh);
  REQUIRE(!claims);
  CHECK(claims.error().code == ErrorCode::CannotOpen);
}
