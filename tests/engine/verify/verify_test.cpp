#include "engine/verify.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

constexpr Index kSide = 9;  // vertices a side of the square, edge 1/4, vertex kSide * row + column

/// A flat square with its own shape for a map: every residual is known.
struct Case {
  Mesh mesh = shapes::height_field(kSide, shapes::flat, 0);
  std::vector<Vec2> uv = {};  ///< [3 T]
  Claims claims = {};
  ConstraintSet set = {};

  Case() {
    for (const Index v : mesh.corner_vertex) uv.push_back({mesh.position[v].x, mesh.position[v].y});
    const Verification found = *verify(mesh.surface(), uv);
    claims.certificate = found.certificate;
    claims.mesh.vertices = mesh.num_vertices();
    claims.mesh.triangles = mesh.num_triangles();
    claims.mesh.components = claims.mesh.boundary_loops = claims.mesh.euler = 1;
  }

  Vec2 place(Index v) const { return {mesh.position[v].x, mesh.position[v].y}; }

  /// A chain feature, and the outcome of a constraint that keeps its shape.
  ConstraintOutcome& add(const std::string& name, const std::string& type, std::vector<Index> chain,
                         bool closed = false) {
    Feature feature;
    feature.name = name;
    feature.vertex = std::move(chain);
    feature.closed = closed;
    const std::size_t n = feature.vertex.size();
    ConstraintOutcome outcome{
        .name = type + " " + name, .type = type, .features = {name}, .scale = 1.0, .orientation = 0.0};
    for (std::size_t k = 0; k < n; ++k) {
      outcome.shape.push_back(place(feature.vertex[k]));
      if (k + 1 < n || closed) feature.length += norm(place(feature.vertex[(k + 1) % n]) - outcome.shape[k]);
    }
    claims.features.push_back(std::move(feature));
    claims.constraints.push_back(std::move(outcome));
    return claims.constraints.back();
  }

  void move(Index v, Vec2 by) {
    for (std::size_t c = 0; c < uv.size(); ++c) {
      if (mesh.corner_vertex[c] == v) uv[c] += by;
    }
  }

  Verification found(bool with_set = false) const {
    const auto result = verify(mesh.surface(), uv, {.claims = &claims, .set = with_set ? &set : nullptr});
    REQUIRE(result);
    return *result;
  }
};

std::vector<Index> row(Index r) {
  std::vector<Index> chain;
  for (Index k = 0; k < kSide; ++k) chain.push_back(kSide * r + k);
  return chain;
}

/// Four edges around an interior vertex's square.
const std::vector<Index> kSquare = {2 * kSide + 2, 2 * kSide + 3, 2 * kSide + 4, 3 * kSide + 4,
                                    4 * kSide + 4, 4 * kSide + 3, 4 * kSide + 2, 3 * kSide + 2};

/// Constraints first, then the report as a whole.
std::string faults(const Verification& v) {
  std::string text;
  for (const ConstraintFinding& finding : v.constraints) {
    for (const std::string& fault : finding.faults) text += finding.name + ": " + fault + "\n";
  }
  for (const std::string& fault : v.faults) text += fault + "\n";
  return text;
}

bool says(const Verification& v, const std::string& part) {
  return faults(v).find(part) != std::string::npos;
}

/// The case after a change does not hold, and says so.
void check_fault(const Case& changed, const std::string& part, bool with_set = false) {
  CAPTURE(part);
  const Verification found = changed.found(with_set);
  CHECK(!found.holds());
  CHECK_MESSAGE(says(found, part), faults(found));
}

Constraint constraint(const std::string& name, const std::string& type, decltype(Constraint::rule) rule) {
  return {.name = name, .type = type, .rule = std::move(rule)};
}

}  // namespace

TEST_CASE("verify: an isometric map holds, without and with a report that says so") {
  Case c;
  c.add("sill", "line", row(4));
  c.add("plate", "curve", kSquare, true);
  const auto alone = verify(c.mesh.surface(), c.uv);
  REQUIRE(alone);
  CHECK(alone->holds());
  CHECK(alone->certificate.arap < 1e-28);
  CHECK(alone->charts == 1);
  const Verification found = c.found();
  CHECK_MESSAGE(found.holds(), faults(found));
  REQUIRE(found.constraints.size() == 2);
  for (const ConstraintFinding& finding : found.constraints) CHECK(finding.residual.value() < 1e-15);
}

TEST_CASE("verify: flipped triangles, and only they, are found and named") {
  Case c;
  c.move(kSide + 1, {0.3, 0.1});
  const auto found = verify(c.mesh.surface(), c.uv);
  REQUIRE(found);
  CHECK(!found->holds());
  CHECK(found->certificate.flipped_triangles > 0);
  for (const Index t : found->certificate.flipped) {
    CHECK(std::ranges::count(c.mesh.corner_vertex.begin() + 3 * t, c.mesh.corner_vertex.begin() + 3 * t + 3,
                             kSide + 1) == 1);
  }
}

TEST_CASE("verify: a fan that covers its middle twice is overwound although no triangle is flipped") {
  Mesh fan;
  std::vector<Vec2> uv;
  fan.position.push_back({0, 0, 0.5});
  for (Index i = 0; i < 12; ++i) {
    const Vec2 p = unit(2 * kPi * i / 12);
    fan.position.push_back({p.x, p.y, 0});
    for (const Index v : {0, 1 + i, 1 + (i + 1) % 12}) {
      fan.corner_vertex.push_back(v);
      uv.push_back(v == 0 ? Vec2{} : unit(4 * kPi * (v - 1) / 12));
    }
  }
  const auto found = verify(fan.surface(), uv);
  REQUIRE(found);
  CHECK(found->certificate.flipped_triangles == 0);
  CHECK(found->certificate.overwound == std::vector<Index>{0});
  CHECK(!found->holds());
}

TEST_CASE("verify: charts that lie on one another overlap, beside one another they do not") {
  const Mesh both = shapes::joined(shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                   shapes::triangle({5, 0, 0}, {6, 0, 0}, {5, 1, 0}));
  std::vector<Vec2> uv;
  for (const Vec3 p : both.position) uv.push_back({p.x, p.y});
  CHECK(verify(both.surface(), uv)->holds());
  for (std::size_t c = 3; c < 6; ++c) uv[c].x -= 5;
  const auto found = verify(both.surface(), uv);
  CHECK(!found->holds());
  CHECK(found->charts == 2);
  CHECK(found->certificate.overlapping_pairs == 1);
  CHECK(found->certificate.overlap_area_fraction == Approx(0.5));
  CHECK(found->overlapping == std::vector<std::array<Index, 2>>{{0, 1}});
}

TEST_CASE(
    "verify: a vertex that leaves its line, circle or shape by 1e-8 of its size is found, by 1e-11 it is "
    "not") {
  for (const std::string type : {"line", "curve", "region"}) {
    CAPTURE(type);
    for (const double step : {1e-11, 1e-8}) {
      Case c;
      if (type == "line") c.add("f", type, row(4));
      if (type == "curve") c.add("f", type, kSquare, true);
      if (type == "region") {
        ConstraintOutcome& outcome = c.add("f", type, {0, 1, kSide + 1});
        c.claims.features.back() = {"f", {}, false, 0, 0, {0}};
        std::vector<Index> own(c.mesh.corner_vertex.begin(), c.mesh.corner_vertex.begin() + 3);
        std::sort(own.begin(), own.end());
        outcome.shape.clear();
        for (const Index v : own) outcome.shape.push_back(c.place(v));
      }
      c.move(type == "line"    ? 4 * kSide + 4
             : type == "curve" ? kSquare[2]
                               : c.mesh.corner_vertex[0],
             {0, step});
      const ConstraintFinding& finding = c.found().constraints.front();
      CHECK(finding.faults.empty() == (step < 1e-10));
      CHECK(finding.residual.value() > 0.05 * step);
      CHECK(finding.residual.value() < 10 * step);
    }
  }
}

TEST_CASE("verify: a line out of order is found, straight and of true lengths as it is elsewhere") {
  Case c;
  c.add("sill", "line", row(4)).shape.clear();  // lengths free
  c.claims.constraints[0].scale.reset();
  CHECK(c.found().constraints[0].faults.empty());
  c.move(4 * kSide + 4, {0.3, 0});
  check_fault(c, "vertices lost their order along the line, the first is 41");
}

TEST_CASE("verify: a mirrored template is found") {
  Case c;
  ConstraintOutcome& bow = c.add("bow", "curve", {0, 1, kSide + 1, kSide + 2, kSide + 3});
  CHECK(c.found().holds());
  for (Vec2& p : bow.shape) p = conjugate(p);
  check_fault(c, "its residual is");
  Case closed;
  ConstraintOutcome& plate = closed.add("plate", "curve", kSquare, true);
  for (Vec2& p : plate.shape) p = conjugate(p);
  check_fault(closed, "run round in opposite directions");
}

TEST_CASE("verify: every number of a report that is not that of the map is named") {
  const std::pair<std::function<void(Claims&)>, const char*> lies[] = {
      {[](Claims& c) { c.certificate.arap = 1e-6; }, "arap energy"},
      {[](Claims& c) { c.certificate.symmetric_dirichlet *= 1 + 1e-8; }, "symmetric Dirichlet"},
      {[](Claims& c) { c.certificate.flipped_triangles = 1; }, "1 flipped triangles, the map has 0"},
      {[](Claims& c) { c.certificate.flipped = {3}; }, "lists flipped triangle 3"},
      {[](Claims& c) { c.certificate.overwound_vertices = 2; }, "2 overwound vertices"},
      {[](Claims& c) { c.certificate.overwound = {3}; }, "lists overwound vertex 3"},
      {[](Claims& c) { c.certificate.overlapping_pairs = 4; }, "4 overlapping pairs"},
      {[](Claims& c) { c.certificate.overlap_area_fraction = 1e-3; }, "area fraction"},
      {[](Claims& c) { c.certificate.sigma_max.max *= 1.001; }, "largest sigma_max"},
      {[](Claims& c) { c.certificate.sigma_min.min *= 0.999; }, "least sigma_min"},
      {[](Claims& c) { c.certificate.area_ratio.mean *= 1.001; }, "mean area ratio"},
      {[](Claims& c) { c.mesh.components = 2; }, "2 components"},
      {[](Claims& c) { c.mesh.boundary_loops = 2; }, "2 boundary loops"},
      {[](Claims& c) { c.mesh.euler = 0; }, "0 Euler characteristic"},
      {[](Claims& c) { c.features[0].length *= 1 + 1e-8; }, "length of feature \"sill\""},
      {[](Claims& c) { c.constraints[0].residual = 1e-8; }, "the report says a residual of 1e-08"},
      {[](Claims& c) { c.constraints[0].residual = kInfinity; }, "the report says a residual of inf"},
      {[](Claims& c) { c.constraints[0].scale = 1 + 1e-7; }, "its scale in the map is 1, the report says"},
      {[](Claims& c) { c.constraints[0].scale.reset(); }, "does not state its scale"},
      {[](Claims& c) { c.constraints[0].orientation = 90; }, "its orientation in the map"},
      {[](Claims& c) { c.constraints[0].keeps_order = false; }, "says that the order along the line is lost"},
      {[](Claims& c) { c.constraints[0].shape[3].x += 1e-6; }, "an edge of its template"},
      {[](Claims& c) { c.constraints[0].shape.pop_back(); },
       "template has 8 points in the report, its feature 9"},
      {[](Claims& c) { c.constraints[0].yielded = {4 * kSide}; },
       "which no constraint of its rank or above holds"},
      {[](Claims& c) { c.constraints[0].yielded = {0}; }, "vertex 0, which is none of its own"},
      {[](Claims& c) { c.constraints[0].features = {"door"}; }, "the report has no feature \"door\""},
      {[](Claims& c) { std::swap(c.features[0].vertex[2], c.features[0].vertex[5]); }, "share no edge"}};
  for (const auto& [lie, said] : lies) {
    Case c;
    c.add("sill", "line", row(4));
    REQUIRE(c.found().holds());
    lie(c.claims);
    check_fault(c, said);
  }
}

TEST_CASE("verify: angles are those of best-fit lines, chords and edges") {
  Case c;
  c.add("sill", "line", row(4));
  c.add("post", "curve", {4, kSide + 4, 2 * kSide + 4});
  ConstraintOutcome angle{
      .name = "square", .type = "perpendicular", .features = {"sill", "post"}, .degrees = 90.0};
  ConstraintOutcome edges{.name = "edges", .type = "angle", .edges = {{0, 1}, {0, kSide}}, .degrees = 90.0};
  ConstraintOutcome level{.name = "level", .type = "direction", .features = {"sill"}, .degrees = 0.0};
  for (const ConstraintOutcome& o : {angle, edges, level}) c.claims.constraints.push_back(o);
  const Verification found = c.found();
  CHECK_MESSAGE(found.holds(), faults(found));
  for (std::size_t k = 2; k < 5; ++k) {
    CHECK(found.constraints[k].degrees);
    CHECK(found.constraints[k].residual.value() < 1e-12);
  }
  c.claims.constraints[2].degrees = 89.0;
  check_fault(c, "square: its angle in the map is 90 degrees, the report says 89");
}

TEST_CASE("verify: what the constraint file asks for is held against the map") {
  Case c;
  c.add("sill", "line", row(4));
  c.claims.constraints.push_back(
      {.name = "level", .type = "direction", .features = {"sill"}, .degrees = 0.0});
  c.claims.constraints.push_back({.name = "pin", .type = "pin", .pinned = {0}});
  c.set.constraints = {constraint("line sill", "line", LineConstraint{.feature = "sill"}),
                       constraint("level", "direction", DirectionConstraint{.feature = "sill"}),
                       constraint("pin", "pin", PinConstraint{{0}, {{-1, -1}}})};
  CHECK(!c.found().constraints[2].residual);
  const Verification fine = c.found(true);
  CHECK_MESSAGE(fine.holds(), faults(fine));
  CHECK(fine.constraints[2].residual.value() == 0);

  const std::pair<std::function<void(ConstraintSet&)>, const char*> others[] = {
      {[](ConstraintSet& s) { std::get<DirectionConstraint>(s.constraints[1].rule).degrees = 1; },
       "level: its residual is 1 degrees"},
      {[](ConstraintSet& s) { std::get<PinConstraint>(s.constraints[2].rule).uv[0].x += 1e-6; },
       "pin: its residual"},
      {[](ConstraintSet& s) { std::get<PinConstraint>(s.constraints[2].rule).vertex[0] = 1; },
       "pin: the report and the constraint file name different"},
      {[](ConstraintSet& s) {
         auto& line = std::get<LineConstraint>(s.constraints[0].rule);
         line.lengths = LineConstraint::Lengths::Scale;
         line.scale.factor = 1.25;
       },
       "the constraint file asks for 1.25"},
      {[](ConstraintSet& s) { s.constraints[0].type = "circle"; }, "it is a line in the report, a circle"},
      {[](ConstraintSet& s) { s.constraints[0].name = "other"; },
       "constraint \"other\" has no answer in the report"},
      {[](ConstraintSet& s) { s.constraints[0].name = "other"; },
       "the report has a constraint \"line sill\", the constraint file none"}};
  for (const auto& [change, said] : others) {
    Case changed = c;
    change(changed.set);
    if (changed.set.constraints[0].type == "circle")
      changed.set.constraints[0].rule = CircleConstraint{.feature = "sill"};
    check_fault(changed, said, true);
  }
}

TEST_CASE("verify: scales of a group are one") {
  Case c;
  for (std::size_t k = 0; k < c.uv.size(); ++k) c.uv[k].x *= 1.5;
  c.claims.certificate = verify(c.mesh.surface(), c.uv)->certificate;
  std::vector<Index> column;
  for (Index k = 0; k < kSide; ++k) column.push_back(kSide * k + 4);
  c.add("across", "line", row(4)).scale = 1.5;
  c.add("up", "line", column).orientation = 90;
  LineConstraint across{.feature = "across", .lengths = LineConstraint::Lengths::Scale}, up = across;
  across.scale = {.factor = std::nullopt, .group = "g"};
  up.scale = across.scale;
  up.feature = "up";
  c.set.constraints = {constraint("line across", "line", across), constraint("line up", "line", up)};
  for (Vec2& p : c.claims.constraints[1].shape) p = {p.y, 0};  // as a report has lines
  check_fault(c, "share the scale group \"g\" and have the scales 1.5 and 1", true);
}

TEST_CASE("verify: a region's template is unrolled truly, its size is the region's") {
  Case c;
  ConstraintOutcome& patch = c.add("patch", "region", row(0));
  std::vector<Index> triangles(32);
  std::vector<Index> own;
  for (Index t = 0; t < 32; ++t) triangles[t] = t;
  for (Index k = 0; k < 96; ++k) own.push_back(c.mesh.corner_vertex[k]);
  std::sort(own.begin(), own.end());
  own.erase(std::unique(own.begin(), own.end()), own.end());
  patch.shape.clear();
  for (const Index v : own) patch.shape.push_back(c.place(v));
  c.claims.features[0] = {"patch", {}, false, 0, 0, triangles};
  REQUIRE(c.found().holds());

  Case larger = c;
  for (Vec2& p : larger.claims.constraints[0].shape) p = 2 * p;
  larger.claims.constraints[0].scale = 0.5;
  larger.claims.constraints[0].planarity = 1;
  check_fault(larger, "its template is 0.5 too large or too small");
  Case stretched = c;
  for (Vec2& p : stretched.claims.constraints[0].shape) p.x *= 1 + 1e-6;
  check_fault(stretched, "its template changes lengths by 1e-06, the report says 0");
  Case mirrored = c;
  for (Vec2& p : mirrored.claims.constraints[0].shape) p = conjugate(p);
  check_fault(mirrored, "32 triangles of its template are turned over or flat, the first is 0");
}

TEST_CASE("verify: what cannot be checked is an error with its code") {
  const Case c;
  const auto code = [](const auto& result) {
    REQUIRE(!result);
    return result.error().code;
  };
  CHECK(code(verify(c.mesh.surface(), In<Vec2>(c.uv).first(6))) == ErrorCode::BadUsage);
  CHECK(code(verify(c.mesh.surface(), c.uv, {.set = &c.set})) == ErrorCode::BadUsage);
  Case infinite;
  infinite.uv[7].x = kInfinity;
  const auto refused = verify(infinite.mesh.surface(), infinite.uv);
  CHECK(code(refused) == ErrorCode::NonFinitePosition);
  CHECK(refused.error().ids == std::vector<Index>{2});
  Case outside;
  outside.add("sill", "line", row(4));
  outside.claims.features[0].vertex[3] = 1000;
  CHECK(code(verify(outside.mesh.surface(), outside.uv, {.claims = &outside.claims})) ==
        ErrorCode::IndexOutOfRange);
  Case pinned;
  pinned.set.constraints = {constraint("pin", "pin", PinConstraint{{1000}, {{0, 0}}})};
  CHECK(code(verify(pinned.mesh.surface(), pinned.uv, {.claims = &pinned.claims, .set = &pinned.set})) ==
        ErrorCode::ConstraintInvalid);
  const Mesh moebius = shapes::moebius(20);
  const std::vector<Vec2> uv(moebius.corner_vertex.size());
  CHECK(code(verify(moebius.surface(), uv)) == ErrorCode::NotOrientable);
}

TEST_CASE("verify: 1, 2 and 7 threads find the same") {
  const Mesh mesh = shapes::wavy_disk(3000);
  std::vector<Vec2> uv;
  for (const Index v : mesh.corner_vertex) uv.push_back({mesh.position[v].x, mesh.position[v].z});
  const auto one = verify(mesh.surface(), uv, {}, {.threads = 1});
  REQUIRE(one);
  CHECK(one->certificate.flipped_triangles > 0);
  CHECK(one->certificate.overlapping_pairs > 0);
  for (const int threads : {2, 7}) {
    const auto many = verify(mesh.surface(), uv, {}, {.threads = threads});
    CHECK(many->certificate.arap == one->certificate.arap);
    CHECK(many->certificate.flipped == one->certificate.flipped);
    CHECK(many->overlapping == one->overlapping);
  }
}
