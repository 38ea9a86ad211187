// What holds for every constraint set that can be met, and what is said of those that cannot.
#include <algorithm>

#include "tests/support/case_generators.hpp"
#include "tests/support/check_property.hpp"
#include "tests/support/constraint_residuals.hpp"
#include "tests/support/random_constraints.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

Flattening solved(const ConstrainedCase& c, FlattenOptions options = {}) {
  if (options.threads == 0) options.threads = 1;
  auto flat = flatten(c.mesh.surface(), c.constraints(), options);
  if (!flat) RC_LOG() << c << std::endl << describe(flat.error()) << std::endl;
  RC_ASSERT(flat.has_value());
  return std::move(*flat);
}

void never_rises(const std::vector<Iterate>& history) {
  for (std::size_t k = 1; k < history.size(); ++k) {
    if (history[k].phase != history[k - 1].phase) continue;
    RC_ASSERT(history[k].energy <= history[k - 1].energy * (1 + 1e-12) + 1e-15);
  }
}

/// Where two angles are as near, or both ways round as good, rounding may choose; and nothing is nearer than another to
/// what is free to turn, as a map with one direction is.
bool same_choices(const Flattening& f, const Flattening& g) {
  const auto directions = std::count_if(f.constraints.outcome.begin(), f.constraints.outcome.end(),
                                        [](const ConstraintOutcome& o) { return o.type == "direction"; });
  for (std::size_t k = 0; k < f.constraints.outcome.size(); ++k) {
    const ConstraintOutcome &a = f.constraints.outcome[k], &b = g.constraints.outcome[k];
    if (a.mirrored != b.mirrored && !a.chirality_open) return false;
    if (a.type == "direction" && directions == 1) continue;
    if (a.degrees && std::abs(std::remainder(*a.degrees - *b.degrees, 360)) > 1e-3) return false;
  }
  return true;
}

void same_energy(const Flattening& f, const Flattening& g) {
  const bool comparable = f.converged && g.converged && same_choices(f, g);
  RC_CLASSIFY(comparable);
  if (!comparable) return;
  RC_ASSERT(std::abs(f.certificate.arap - g.certificate.arap) <= 1e-9 * f.certificate.arap + 1e-13);
}

}  // namespace

TEST_CASE("constraints: sets that can be met are met, and the energy never rises") {
  check_property(300, [] {
    const ConstrainedCase c = feasible_case(*case_seeds(200, 2000, 12));
    const Flattening f = solved(c);
    RC_LOG() << c << std::endl;
    never_rises(f.history);
    for (const MeasuredResidual& r : measure_residuals(c, f.uv, f.constraints.outcome)) {
      RC_LOG() << r.name << ": " << r.residual << std::endl;
      RC_ASSERT(r.residual <= (r.is_angle ? 1e-7 : 1e-9));
    }
    for (const ConstraintOutcome& o : f.constraints.outcome) {
      RC_ASSERT(o.residual <= (o.degrees ? 1e-7 : 1e-9));
      RC_ASSERT(o.mismatch == 0);
    }
    RC_CLASSIFY(f.converged, "converged");
    RC_CLASSIFY(c.set.constraints.size() > 4, "more than 4 constraints");
    RC_ASSERT(f.holonomy_residual <= 1e-9);
    if (f.history.back().phase != Phase::LocalGlobal) return;
    RC_ASSERT(std::abs(f.history.back().energy - f.certificate.arap) <= 1e-9 * f.certificate.arap + 1e-15);
  });
}

TEST_CASE("constraints: a moved surface has the same minimum") {
  check_property(100, [] {
    const ConstrainedCase c = feasible_case(*case_seeds(200, 1200, 10));
    const auto seed = *rc::gen::noShrink(rc::gen::arbitrary<std::uint32_t>());
    RC_LOG() << c << std::endl;
    const Flattening f = solved(c), g = solved(rigid_motion(c, seed));
    same_energy(f, g);
  });
}

TEST_CASE("constraints: relabelled vertices and triangles have the same minimum") {
  check_property(100, [] {
    const ConstrainedCase c = feasible_case(*case_seeds(200, 1200, 10));
    const auto seed = *rc::gen::noShrink(rc::gen::arbitrary<std::uint32_t>());
    RC_LOG() << c << std::endl;
    std::vector<Index> new_of_old;
    const Flattening f = solved(c), g = solved(relabelled(c, seed, new_of_old));
    same_energy(f, g);
  });
}

TEST_CASE("constraints: units change nothing but the scale") {
  check_property(60, [] {
    const ConstrainedCase c = feasible_case(*case_seeds(200, 1200, 10));
    RC_LOG() << c << std::endl;
    const Flattening f = solved(c);
    for (const double factor : {1000.0, 1e-6}) {
      const ConstrainedCase other = scaled(c, factor);
      const Flattening g = solved(other);
      same_energy(f, g);
      for (const MeasuredResidual& r : measure_residuals(other, g.uv, g.constraints.outcome)) {
        RC_LOG() << r.name << ": " << r.residual << std::endl;
        RC_ASSERT(r.residual <= (r.is_angle ? 1e-7 : 1e-9));
      }
    }
  });
}

TEST_CASE("constraints: 1, 2 and 5 threads give the same bits") {
  check_property(50, [] {
    const ConstrainedCase c = feasible_case(*case_seeds(600, 2000, 10));
    RC_LOG() << c << std::endl;
    const Flattening one = solved(c);
    for (const int threads : {2, 5}) {
      const Flattening other = solved(c, {.threads = threads});
      RC_ASSERT(other.uv == one.uv);
      RC_ASSERT(other.certificate.arap == one.certificate.arap);
      RC_ASSERT(other.iterations == one.iterations);
    }
  });
}

TEST_CASE("constraints: directions that may turn never cost energy") {
  check_property(150, [] {
    const ConstrainedCase c = feasible_case(*case_seeds(200, 1000, 10));
    RC_LOG() << c << std::endl;
    const Flattening kept = solved(c, {.flips = Flips::Keep, .keep_directions = true}),
                     free = solved(c, {.flips = Flips::Keep});
    never_rises(kept.history);
    never_rises(free.history);
    RC_LOG() << "kept " << kept.history.back().energy << ", free " << free.history.back().energy << std::endl;
    // The hand-over to free directions changes no position.
    RC_ASSERT(std::abs(kept.history.front().energy - free.history.front().energy) <=
              1e-9 * kept.history.front().energy + 1e-15);
    RC_CLASSIFY(kept.converged && free.converged, "both converged");
    if (kept.converged && free.converged)
      RC_ASSERT(free.history.back().energy <= kept.history.back().energy * (1 + 1e-9) + 1e-15);
  });
}

TEST_CASE("constraints: contradictions are refused, and name the constraints at fault alone") {
  check_property(300, [] {
    const int kind = *rc::gen::resize(100, rc::gen::inRange(0, kNumContradictions));
    std::vector<std::string> named;
    const ConstrainedCase c = contradictory_case(*case_seeds(200, 800, 6), kind, named);
    RC_LOG() << contradiction_name(kind) << ": " << c << std::endl;
    const auto flat = flatten(c.mesh.surface(), c.constraints(), {.threads = 1});
    RC_ASSERT_FALSE(flat.has_value());
    const std::string message = describe(flat.error());
    RC_LOG() << message << std::endl;
    RC_ASSERT(flat.error().code == ErrorCode::ConstraintsConflict);
    for (const Constraint& constraint : c.set.constraints) {
      const bool is_named = message.find('"' + constraint.name + '"') != std::string::npos;
      const bool at_fault = std::find(named.begin(), named.end(), constraint.name) != named.end();
      // Of a rectangle's right angles any three force the fourth.
      if (constraint.type == "perpendicular" && !at_fault) continue;
      RC_ASSERT(is_named == at_fault);
    }
    RC_TAG(std::string(contradiction_name(kind)));
  });
}

// ---- what random cases have found ----

namespace {

double bump(double x, double y) { return 0.3 * std::exp(-x * x - y * y) + 0.1 * x * y; }

ConstrainedCase on_grid(Mesh mesh, std::vector<Feature> features, std::vector<Constraint> constraints) {
  ConstrainedCase c{.mesh = std::move(mesh), .set = {}, .features = std::move(features)};
  c.set.constraints = std::move(constraints);
  return c;
}

}  // namespace

TEST_CASE("constraints: a straight chain is no arc unless its sweep is given, and then either side will do") {
  const Feature side{.name = "side", .vertex = {0, 1, 2, 3, 4, 5, 6, 7, 8}, .triangle = {}};
  CircleConstraint arc{.feature = "side", .radius = {}, .sweep_degrees = {}, .mirror = {}};
  const Mesh mesh = shapes::rigid_motion(shapes::height_field(9, shapes::flat), 3);
  const ConstrainedCase c = on_grid(mesh, {side}, {{"arc", "circle", arc}});
  const auto refused = flatten(c.mesh.surface(), c.constraints());
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::ConstraintInvalid);
  arc.sweep_degrees = 30;
  const ConstrainedCase given = on_grid(mesh, {side}, {{"arc", "circle", arc}});
  const auto flat = flatten(given.mesh.surface(), given.constraints());
  REQUIRE(flat);
  CHECK(flat->constraints.outcome[0].chirality_open);
  CHECK(flat->constraints.outcome[0].residual < 1e-12);
}

TEST_CASE("constraints: a curved boundary keeps its shape where a corner has one triangle") {
  const Mesh mesh = shapes::height_field(9, bump);
  Feature rim{.name = "rim", .vertex = {}, .closed = true, .triangle = {}};
  for (Index i = 0; i < 8; ++i) rim.vertex.push_back(i);
  for (Index j = 0; j < 8; ++j) rim.vertex.push_back(9 * j + 8);
  for (Index i = 8; i > 0; --i) rim.vertex.push_back(72 + i);
  for (Index j = 8; j > 0; --j) rim.vertex.push_back(9 * j);
  const ConstrainedCase c =
      on_grid(mesh, {rim}, {{"rim", "curve", CurveConstraint{.feature = "rim", .scale = {}, .mirror = {}}}});
  const auto flat = flatten(c.mesh.surface(), c.constraints());
  REQUIRE(flat);
  CHECK(flat->constraints.outcome[0].residual < 1e-12);
  CHECK(flat->certificate.flipped_triangles == 0);
}

TEST_CASE("constraints: a direction that may be taken either way suits the one that may not") {
  const Feature low{.name = "low", .vertex = {0, 1, 2, 3, 4, 5, 6, 7, 8}, .triangle = {}};
  const Feature high{.name = "high", .vertex = {72, 73, 74, 75, 76, 77, 78, 79, 80}, .triangle = {}};
  const LineConstraint::Lengths scale = LineConstraint::Lengths::Scale;
  for (const double degrees : {40.0, 130.0, 220.0, 310.0}) {
    const ConstrainedCase c =
        on_grid(shapes::height_field(9, bump), {low, high},
                {{"a", "line", LineConstraint{"low", scale, {.factor = {}, .group = {}}}},
                 {"b", "line", LineConstraint{"high", scale, {.factor = {}, .group = {}}}},
                 {"along", "direction", DirectionConstraint{"low", {}, {}, std::fmod(degrees, 180.0), false}},
                 {"against", "direction", DirectionConstraint{"high", {}, {}, degrees, true}}});
    const auto flat = flatten(c.mesh.surface(), c.constraints());
    REQUIRE(flat);
    CHECK(flat->certificate.flipped_triangles == 0);
    for (const MeasuredResidual& r : measure_residuals(c, flat->uv, flat->constraints.outcome))
      CHECK(r.residual < 1e-9);
    CHECK(dot(flat->uv[8] - flat->uv[0], flat->uv[80] - flat->uv[72]) > 0);
  }
}
