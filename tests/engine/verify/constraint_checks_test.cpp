// What verify finds in single constraints, of a report alone and of a report with its constraint file.
#include "tests/engine/verify/verify_support.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

/// Twelve triangles around vertex 0; vertices 1 to 12 on the unit circle.
Mesh wheel() {
  Mesh mesh;
  mesh.position.push_back({0, 0, 0});
  for (Index i = 0; i < 12; ++i) {
    const Vec2 p = unit(2 * kPi * i / 12);
    mesh.position.push_back({p.x, p.y, 0});
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {0, 1 + i, 1 + (i + 1) % 12});
  }
  return mesh;
}

std::vector<Index> rim(Index count) {
  std::vector<Index> chain;
  for (Index k = 0; k < count; ++k) chain.push_back(1 + k);
  return chain;
}

/// Puts the images of a chain at given places.
void place(Case& c, const std::vector<Index>& chain, const std::vector<Vec2>& at) {
  for (std::size_t k = 0; k < c.uv.size(); ++k) {
    const auto found = std::ranges::find(chain, c.mesh.corner_vertex[k]);
    if (found != chain.end()) c.uv[k] = at[static_cast<std::size_t>(found - chain.begin())];
  }
}

/// The square torn along its middle column, whose vertices these are from the bottom up.
Case torn_square(std::vector<Index>& column) {
  Case c;
  for (Index k = 0; k < kSide; ++k) column.push_back(kSide * k + 4);
  for (Index t = 0; t < c.mesh.num_triangles(); ++t) {
    double x = 0;
    for (Index k = 3 * t; k < 3 * t + 3; ++k) x += c.place(c.mesh.corner_vertex[k]).x;
    for (Index k = 3 * t; x > 0 && k < 3 * t + 3; ++k) c.uv[k].x += 10;
  }
  c.claims.cut_edges = kSide - 1;
  return c;
}

}  // namespace

TEST_CASE("verify: a round rim is a circle, and one whose vertices slid along it is not that of its edges") {
  Case c(wheel());
  c.add("rim", "circle", rim(12), true);
  const Verification found = c.found();
  CHECK_MESSAGE(found.holds(), faults(found));
  CHECK(found.constraints[0].residual.value() < 1e-15);
  Case slid = c;
  place(slid, {3}, {unit(2 * kPi * 2 / 12 + 1e-6)});
  check_fault(slid, "circle rim: its residual is");
  Case turned = c;
  place(turned, {3, 4}, {c.place(4), c.place(3)});
  check_fault(turned, "its image bends both ways");
  Case twice(wheel());
  twice.add("rim", "circle", rim(12), true);
  std::vector<Vec2> at;
  for (Index k = 0; k < 12; ++k) at.push_back(unit(4 * kPi * k / 12));
  place(twice, rim(12), at);
  check_fault(twice, "its image goes 2.000 times around");
}

TEST_CASE("verify: an arc without a sweep in the file has that of its best-fit circle in space") {
  Case c(wheel());
  ConstraintOutcome& arc = c.add("arch", "circle", rim(7));
  c.set.constraints = {constraint("circle arch", "circle", CircleConstraint{.feature = "arch"})};
  CHECK_MESSAGE(c.found(true).holds(), faults(c.found(true)));
  // The same chords on a circle of twice the radius, in the map as in the template.
  const double step = 2 * std::asin(0.5 * std::sin(kPi / 12));
  for (std::size_t k = 0; k < 7; ++k) arc.shape[k] = 2 * unit(step * static_cast<double>(k));
  place(c, rim(7), arc.shape);
  CHECK(!says(c.found(), "sweeps"));
  check_fault(c, "its template sweeps 89.", true);
}

TEST_CASE("verify: a line whose template is bent is no line, whatever the residual against it") {
  Case c;
  ConstraintOutcome& sill = c.add("sill", "line", row(0));
  for (std::size_t k = 5; k < 9; ++k)
    sill.shape[k] = sill.shape[4] + multiply(unit(-0.1), sill.shape[k] - sill.shape[4]);
  place(c, row(0), sill.shape);
  check_fault(c, "line sill: its residual is");
}

TEST_CASE("verify: a curve is mirrored where the file says so") {
  Case c;
  c.add("bow", "curve", {0, 1, kSide + 1, kSide + 2, kSide + 3});
  c.set.constraints = {constraint("curve bow", "curve", CurveConstraint{.feature = "bow", .mirror = false})};
  CHECK_MESSAGE(c.found(true).holds(), faults(c.found(true)));
  std::get<CurveConstraint>(c.set.constraints[0].rule).mirror = true;
  check_fault(c, "\"mirror\" is true in the constraint file, \"mirrored\" false in the report", true);
}

TEST_CASE(
    "verify: a vertex may have yielded to a constraint of the same or a higher rank, and lies near its "
    "place") {
  Case c;
  c.add("sill", "line", row(4));
  c.add("bow", "curve", {3 * kSide + 4, 4 * kSide + 4, 4 * kSide + 5, 3 * kSide + 5}).yielded = {4 * kSide +
                                                                                                 4};
  c.set.constraints = {constraint("line sill", "line", LineConstraint{.feature = "sill"}),
                       constraint("curve bow", "curve", CurveConstraint{.feature = "bow"})};
  CHECK_MESSAGE(c.found(true).holds(), faults(c.found(true)));
  Case strayed = c;
  strayed.claims.constraints[1].shape[1].y += 0.1;
  CHECK(!says(strayed.found(), "far beyond the agreement"));
  check_fault(strayed, "far beyond the agreement", true);
  Case downwards = c;
  std::swap(downwards.claims.constraints[0].yielded, downwards.claims.constraints[1].yielded);
  check_fault(downwards, "\"line sill\" yielded vertex 40, which no constraint of its rank or above holds");
}

TEST_CASE("verify: an angle is measured as the file says, and oriented where it does") {
  Case c;
  c.add("bow", "curve", {0, 1, 2, kSide + 2});
  const double chord = 180 / kPi * std::atan2(1, 2);
  c.claims.constraints.push_back(
      {.name = "level", .type = "direction", .features = {"bow"}, .degrees = chord});
  DirectionConstraint rule{.feature = "bow", .measure = Measure::Chord, .degrees = chord};
  const auto set = [&] {
    c.set.constraints = {constraint("curve bow", "curve", CurveConstraint{.feature = "bow"}),
                         constraint("level", "direction", rule)};
  };
  set();
  CHECK_MESSAGE(c.found(true).holds(), faults(c.found(true)));
  rule.measure = Measure::Line;
  set();
  check_fault(c, "level: its angle in the map is ", true);
  rule = {.feature = "bow", .degrees = -chord};  // undirected: plus or minus
  set();
  CHECK(c.found(true).holds());
  rule.oriented = true;
  set();
  check_fault(c, "level: its residual is", true);
}

TEST_CASE("verify: a constraint on a seam has an entry a side, each measured on its own side") {
  std::vector<Index> column;
  Case c = torn_square(column);
  for (const int side : {1, 2}) {
    ConstraintOutcome& outcome = c.add("seam", "line", column);
    outcome.side = side;
    outcome.orientation = 90;
    for (Vec2& p : outcome.shape) p = {p.y, 0};
  }
  c.claims.features.pop_back();
  c.claims.certificate = verify(c.mesh.surface(), c.uv)->certificate;
  c.claims.mesh.components = c.claims.mesh.boundary_loops = c.claims.mesh.euler = 2;
  c.set.constraints = {constraint("line seam", "line", LineConstraint{.feature = "seam"})};
  CHECK_MESSAGE(c.found(true).holds(), faults(c.found(true)));

  Case bent = c;  // the left side's copy of one vertex
  for (std::size_t k = 0; k < bent.uv.size(); ++k) {
    if (bent.mesh.corner_vertex[k] == column[3] && bent.uv[k].x < 5) bent.uv[k].x += 1e-6;
  }
  const Verification found = bent.found();
  CHECK(!found.constraints[0].faults.empty());
  CHECK(found.constraints[1].faults.empty());

  Case once = c;
  once.claims.constraints.pop_back();
  once.claims.constraints[0].side = 0;
  check_fault(once, "constraint \"line seam\" is on a seam, and has one entry, not one a side", true);
  Case thrice = c;
  thrice.claims.constraints.push_back(c.claims.constraints[0]);
  check_fault(thrice, "constraint \"line seam\" has 3 entries in the report", true);
  Case uncut = c;
  uncut.claims.cut_edges.reset();
  check_fault(uncut, "the report says 0 cut edges, the map has 8");
  Case across = c;
  across.add("sill", "curve", row(4));
  check_fault(across, "the map is torn across its feature between vertices");
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

TEST_CASE("verify: a line that is longer than in space does not keep its lengths, whatever scale is stated") {
  Case c;
  for (Vec2& z : c.uv) z = {1.5 * z.x, z.y};
  c.claims.certificate = verify(c.mesh.surface(), c.uv)->certificate;
  c.add("sill", "line", row(4)).scale = 1.5;
  CHECK_MESSAGE(c.found().holds(), faults(c.found()));
  c.set.constraints = {constraint("line sill", "line", LineConstraint{.feature = "sill"})};
  check_fault(c, "its scale in the map is 1.5, the constraint file asks for 1", true);
  check_fault(c, "its residual is", true);
}

TEST_CASE("verify: each vertex of a pin lies where the file says") {
  Case c;
  c.claims.constraints.push_back({.name = "pin", .type = "pin", .pinned = {0, 8}});
  for (const double step : {0.0, 1e-6}) {
    c.set.constraints = {constraint("pin", "pin", PinConstraint{{0, 8}, {{-1 + step, -1}, {1, -1}}})};
    CHECK(c.found(true).holds() == (step == 0));
    c.set.constraints = {constraint("pin", "pin", PinConstraint{{0, 8}, {{-1, -1}, {1, -1 - step}}})};
    CHECK(c.found(true).holds() == (step == 0));
  }
}

TEST_CASE("verify: shapes that shrank to a point are not met, in the template or in the map") {
  for (const bool of_template : {true, false}) {
    Case c;
    ConstraintOutcome& bow = c.add("bow", "curve", {0, 1, kSide + 1});
    if (of_template) bow.shape.assign(3, {0, 0});
    if (!of_template) place(c, {0, 1, kSide + 1}, std::vector<Vec2>(3, {-1, -1}));
    c.set.constraints = {constraint("curve bow", "curve", CurveConstraint{.feature = "bow"})};
    const ConstraintFinding finding = c.found(true).constraints[0];
    CHECK(!(finding.residual.value() <= finding.allowed));
    check_fault(c, "curve bow: its residual is", true);
  }
  Case c;
  c.add("patch", "region", row(0)).shape.clear();
  c.claims.features[0] = {"patch", {}, false, 0, 0, {}};
  check_fault(c, "region patch: its feature has no triangles");
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
