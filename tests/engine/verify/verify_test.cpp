// What the whole of verify finds in maps and in the numbers of reports.
#include "tests/engine/verify/verify_support.hpp"

using namespace planish;
using namespace planish::tests;
using doctest::Approx;

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
  fan.position.assign(2, {0, 0, 0.5});  // the first is unreferenced
  for (Index i = 0; i < 12; ++i) {
    const Vec2 p = unit(2 * kPi * i / 12);
    fan.position.push_back({p.x, p.y, 0});
    for (const Index v : {1, 2 + i, 2 + (i + 1) % 12}) {
      fan.corner_vertex.push_back(v);
      uv.push_back(v == 1 ? Vec2{} : unit(4 * kPi * (v - 2) / 12));
    }
  }
  const auto found = verify(fan.surface(), uv);
  REQUIRE(found);
  CHECK(found->certificate.flipped_triangles == 0);
  CHECK(found->certificate.overwound == std::vector<Index>{1});
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
      const ConstraintFinding finding = c.found().constraints.front();
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
      {[](Claims& c) { c.certificate.benchmark.max_area_distortion = 1e-6; }, "largest area distortion"},
      {[](Claims& c) { c.certificate.benchmark.average_area_error = 1e-6; }, "average area error"},
      {[](Claims& c) { c.certificate.benchmark.min_singular_value *= 0.999; }, "least singular value"},
      {[](Claims& c) { c.certificate.benchmark.max_singular_value *= 1.001; }, "largest singular value"},
      {[](Claims& c) { c.certificate.benchmark.proportion_flipped_triangles = 0.1; },
       "proportion of flipped"},
      {[](Claims& c) { c.certificate.benchmark.bijectivity_violation_area = 1e-6; }, "bijectivity violation"},
      {[](Claims& c) { c.certificate.benchmark.max_angle_distortion = 1e-6; }, "largest angle distortion"},
      {[](Claims& c) { c.certificate.benchmark.average_angle_error = 1e-6; }, "average angle error"},
      {[](Claims& c) { c.certificate.benchmark.resolution *= 1.001; }, "a resolution"},
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
