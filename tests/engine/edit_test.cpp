// Editing a map: what is solved again is what a fresh editor finds, and what failed leaves the map as it was.
#include "engine/edit.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/deform.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// A wavy disk, its free map, and pins at places of that map.
struct Scene {
  Mesh mesh = shapes::wavy_disk(3000);
  std::vector<Vec2> map;
  ConstraintSet set;
  std::vector<Feature> features;

  Scene() {
    auto flat = flatten(mesh.surface(), {.tolerance = 1e-9});
    REQUIRE(flat.has_value());
    map = flat->uv;
    PinConstraint pins;
    for (Index k = 0; k < 5; ++k) {
      pins.vertex.push_back(k * (mesh.num_vertices() / 5) + 7);
      pins.uv.push_back(map[pins.vertex.back()]);
    }
    set.constraints.push_back({.name = "pins", .type = "pin", .rule = pins});
  }
  PinConstraint& pins() { return std::get<PinConstraint>(set.constraints.front().rule); }
  Constraints constraints() const { return {.set = &set, .features = &features}; }
  MapEditor editor(int threads = 0) const {
    auto begun = MapEditor::begin(mesh.surface(), map, {.threads = threads});
    REQUIRE(begun.has_value());
    REQUIRE(begun->constrain(constraints()).has_value());
    return std::move(*begun);
  }
};

constexpr SolveOptions kExact{.tolerance = 1e-9};

double farthest(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, norm(a[v] - b[v]));
  return most;
}

/// A grid in the plane, and itself as its map.
std::pair<Mesh, std::vector<Vec2>> flat_grid(Index side) {
  std::pair<Mesh, std::vector<Vec2>> grid{shapes::height_field(side, shapes::flat, 0), {}};
  for (const Vec3 p : grid.first.position) grid.second.push_back({p.x, p.y});
  return grid;
}

ErrorCode code(const Result<void>& failed) {
  REQUIRE(!failed.has_value());
  return failed.error().code;
}

}  // namespace

TEST_CASE("edit: after moves of a pin the map is the one that a fresh editor finds") {
  Scene scene;
  MapEditor editor = scene.editor();
  REQUIRE(editor.solve(kExact).has_value());
  for (const Vec2 by : {Vec2{0.02, 0.01}, Vec2{-0.03, 0.02}, Vec2{0.01, 0}}) {
    Vec2& uv = scene.pins().uv[2];
    uv += by;
    REQUIRE(editor.move_pin(scene.pins().vertex[2], uv).has_value());
    REQUIRE(editor.solve(kExact).has_value());
    CHECK(editor.uv()[scene.pins().vertex[2]] == uv);
    MapEditor fresh = scene.editor();
    REQUIRE(fresh.solve(kExact).has_value());
    CHECK(farthest(editor.uv(), fresh.uv()) < 1e-6);
    CHECK(editor.measure().flattening.certificate.flipped_triangles == 0);
  }
}

TEST_CASE("edit: a pin carried over a line is where it was put, whatever had to be let go for it") {
  const auto [mesh, map] = flat_grid(21);
  std::vector<Feature> features = {{.name = "row"}};
  for (Index k = 3; k < 18; ++k) features[0].vertex.push_back(5 * 21 + k);
  PinConstraint pins{.vertex = {6 * 21 + 10, 4 * 21 + 5, 4 * 21 + 15}, .uv = {}};
  for (const Index v : pins.vertex) pins.uv.push_back(map[v]);
  ConstraintSet set;
  LineConstraint line;
  line.feature = "row";
  set.features.push_back({.name = "row", .source = VertexSource{.vertex = features[0].vertex}});
  set.constraints.push_back({.name = "line", .type = "line", .rule = line});
  set.constraints.push_back({.name = "pins", .type = "pin", .rule = pins});
  auto editor = MapEditor::begin(mesh.surface(), map);
  REQUIRE(editor.has_value());
  REQUIRE(editor->constrain({.set = &set, .features = &features}).has_value());
  REQUIRE(editor->solve().has_value());
  const Vec2 to = map[4 * 21 + 10];
  REQUIRE(editor->move_pin(pins.vertex[0], to).has_value());
  REQUIRE(editor->solve().has_value());
  const Deformation after = editor->measure();
  CHECK(norm(editor->uv()[pins.vertex[0]] - to) < 1e-12);
  for (const ConstraintOutcome& outcome : after.flattening.constraints.outcome)
    CHECK(outcome.residual < 1e-9);
}

TEST_CASE(
    "edit: lines go where a fresh editor puts them, whether the pin that moves lies beside them, on one, or "
    "alone") {
  const auto [mesh, map] = flat_grid(21);
  std::vector<Feature> features = {{.name = "row"}};
  for (Index k = 3; k < 18; ++k) features[0].vertex.push_back(5 * 21 + k);
  ConstraintSet set;
  LineConstraint line;
  line.feature = "row";
  set.features.push_back({.name = "row", .source = VertexSource{.vertex = features[0].vertex}});
  set.constraints.push_back({.name = "line", .type = "line", .rule = line});
  set.constraints.push_back({.name = "pins", .type = "pin", .rule = PinConstraint{}});
  const Vec2 by{0.013, 0.008};
  const Index on_line = 5 * 21 + 3, beside = 12 * 21 + 10;
  for (const std::vector<Index>& pinned :
       {std::vector<Index>{beside}, {beside, 2, 437}, {on_line, 2, 437}, {on_line}, {beside, on_line}}) {
    auto& pins = std::get<PinConstraint>(set.constraints.back().rule);
    pins.vertex = pinned;
    pins.uv.clear();
    for (const Index v : pinned) pins.uv.push_back(map[v]);
    const auto begun = [&] {
      auto editor = MapEditor::begin(mesh.surface(), map);
      REQUIRE(editor.has_value());
      REQUIRE(editor->constrain({.set = &set, .features = &features}).has_value());
      REQUIRE(editor->solve(kExact).has_value());
      return std::move(*editor);
    };
    CAPTURE(pinned.size());
    CAPTURE(pinned[0]);
    MapEditor editor = begun();
    for (int move = 1; move <= 2; ++move) {
      pins.uv[0] += by;
      REQUIRE(editor.move_pin(pinned[0], pins.uv[0]).has_value());
      REQUIRE(editor.solve(kExact).has_value());
      const MapEditor fresh = begun();
      CHECK(farthest(editor.uv(), fresh.uv()) < 1e-6);
    }
  }
}

TEST_CASE(
    "edit: a pin carried over the opposite side of its triangle, which two others hold, is refused and "
    "stays") {
  const auto [mesh, map] = flat_grid(9);
  const Index* corner = &mesh.corner_vertex[3 * 60];
  PinConstraint pins{.vertex = {corner[0], corner[1], corner[2]}, .uv = {}};
  for (const Index v : pins.vertex) pins.uv.push_back(map[v]);
  ConstraintSet set;
  set.constraints.push_back({.name = "pins", .type = "pin", .rule = pins});
  auto editor = MapEditor::begin(mesh.surface(), map);
  REQUIRE(editor.has_value());
  REQUIRE(editor->constrain({.set = &set}).has_value());
  REQUIRE(editor->solve().has_value());
  const Vec2 opposite = pins.uv[1] + pins.uv[2] - pins.uv[0];
  CHECK(code(editor->move_pin(pins.vertex[0], opposite)) == ErrorCode::ConstraintsConflict);
  CHECK(code(editor->move_pin(pins.vertex[0], {kInfinity, 0})) == ErrorCode::BadUsage);
  const Vec2 near = pins.uv[0] + 0.1 * (pins.uv[0] - opposite);
  REQUIRE(editor->move_pin(pins.vertex[0], near).has_value());
  REQUIRE(editor->solve().has_value());
  CHECK(editor->uv()[pins.vertex[0]] == near);
}

TEST_CASE("edit: a pin that its feature cannot follow stays, and others can be moved") {
  const auto [mesh, map] = flat_grid(21);
  std::vector<Feature> features = {{.name = "row"}};
  for (Index k = 3; k < 18; ++k) features[0].vertex.push_back(5 * 21 + k);
  ConstraintSet set;
  LineConstraint line;  // its lengths kept
  line.feature = "row";
  PinConstraint pins{.vertex = {5 * 21 + 3, 5 * 21 + 17, 12 * 21 + 10}, .uv = {}};
  for (const Index v : pins.vertex) pins.uv.push_back(map[v]);
  set.features.push_back({.name = "row", .source = VertexSource{.vertex = features[0].vertex}});
  set.constraints.push_back({.name = "line", .type = "line", .rule = line});
  set.constraints.push_back({.name = "pins", .type = "pin", .rule = pins});
  auto editor = MapEditor::begin(mesh.surface(), map);
  REQUIRE(editor.has_value());
  REQUIRE(editor->constrain({.set = &set, .features = &features}).has_value());
  REQUIRE(editor->solve(kExact).has_value());
  CHECK(code(editor->move_pin(pins.vertex[0], pins.uv[0] - Vec2{0.1, 0})) == ErrorCode::ConstraintsConflict);
  const Vec2 to = pins.uv[2] + Vec2{0.01, 0.02};
  REQUIRE(editor->move_pin(pins.vertex[2], to).has_value());
  REQUIRE(editor->solve(kExact).has_value());
  CHECK(norm(editor->uv()[pins.vertex[0]] - pins.uv[0]) < 1e-12);
  CHECK(norm(editor->uv()[pins.vertex[1]] - pins.uv[1]) < 1e-12);
  CHECK(norm(editor->uv()[pins.vertex[2]] - to) < 1e-12);
}

TEST_CASE("edit: a given map without flips is where the steps begin") {
  const Scene scene;
  std::vector<Vec2> sheared = scene.map;
  for (Vec2& z : sheared) z.x += 0.4 * z.y;
  const auto deformed = deform(scene.mesh.surface(), sheared, {}, {.edit = {}, .solve = kExact});
  REQUIRE(deformed.has_value());
  const std::vector<Iterate>& history = deformed->flattening.history;
  CHECK(history.front().energy == doctest::Approx(deformed->facts.given_arap));
  CHECK(history.back().energy < 0.1 * history.front().energy);
}

TEST_CASE("edit: a pin moved away and back leads back") {
  Scene scene;
  MapEditor editor = scene.editor();
  REQUIRE(editor.solve(kExact).has_value());
  const std::vector<Vec2> before = editor.uv();
  const Index vertex = scene.pins().vertex[1];
  REQUIRE(editor.move_pin(vertex, scene.pins().uv[1] + Vec2{0.05, -0.02}).has_value());
  REQUIRE(editor.solve(kExact).has_value());
  CHECK(farthest(editor.uv(), before) > 0.01);
  REQUIRE(editor.move_pin(vertex, scene.pins().uv[1]).has_value());
  REQUIRE(editor.solve(kExact).has_value());
  CHECK(farthest(editor.uv(), before) < 1e-6);
}

TEST_CASE("edit: other constraints take the place of the ones before") {
  Scene scene;
  MapEditor editor = scene.editor();
  REQUIRE(editor.solve(kExact).has_value());
  PinConstraint& pins = scene.pins();
  pins.vertex.pop_back();
  pins.uv.pop_back();
  pins.uv[0] += Vec2{0.03, 0};
  REQUIRE(editor.constrain(scene.constraints()).has_value());
  REQUIRE(editor.solve(kExact).has_value());
  MapEditor fresh = scene.editor();
  REQUIRE(fresh.solve(kExact).has_value());
  CHECK(farthest(editor.uv(), fresh.uv()) < 1e-6);
  CHECK(editor.measure().flattening.constraints.outcome.front().residual < 1e-12);
}

TEST_CASE("edit: without constraints the map stays as near to the given one as it can") {
  const Scene scene;
  auto editor = MapEditor::begin(scene.mesh.surface(), scene.map);
  REQUIRE(editor.has_value());
  REQUIRE(editor->constrain({}).has_value());
  REQUIRE(editor->solve(kExact).has_value());
  CHECK(farthest(editor->uv(), scene.map) < 1e-6);
}

TEST_CASE("edit: a solve that is stopped leaves the map as it was") {
  Scene scene;
  MapEditor editor = scene.editor();
  REQUIRE(editor.solve().has_value());
  const std::vector<Vec2> before = editor.uv();
  REQUIRE(editor.move_pin(scene.pins().vertex[0], scene.pins().uv[0] + Vec2{0.01, 0}).has_value());
  int iterations = 0;
  const auto stopped = editor.solve({}, [&](const Progress& progress) {
    iterations += progress.phase == Phase::LocalGlobal && progress.iteration > 0;
    return iterations > 2 ? Verdict::Stop : Verdict::Continue;
  });
  REQUIRE(!stopped.has_value());
  CHECK(stopped.error().code == ErrorCode::Cancelled);
  CHECK(editor.uv() == before);
}

TEST_CASE("edit: 1, 2 and 7 threads give the same bits, after moves too") {
  Scene scene;
  const auto moved = [&](int threads) {
    MapEditor editor = scene.editor(threads);
    REQUIRE(editor.solve({.steps = 3}).has_value());
    REQUIRE(editor.move_pin(scene.pins().vertex[3], scene.pins().uv[3] + Vec2{0.02, 0.02}).has_value());
    REQUIRE(editor.solve().has_value());
    return editor.uv();
  };
  const std::vector<Vec2> one = moved(1);
  for (const int threads : {2, 7}) CHECK(moved(threads) == one);
}

TEST_CASE("edit: steps tell the sink where they are, from the map as it was to the last one") {
  Scene scene;
  scene.pins().uv[0] += Vec2{0.05, 0.05};
  MapEditor editor = scene.editor();
  std::vector<DeformStep> steps;
  REQUIRE(editor
              .solve({.steps = 4}, {},
                     [&](DeformStep step) -> Result<void> {
                       steps.push_back(std::move(step));
                       return {};
                     })
              .has_value());
  REQUIRE(steps.size() == 5);
  CHECK(farthest(steps.front().uv, editor.given_uv()) < 1e-12);
  CHECK(steps.back().uv == editor.uv());
  const Index pin = scene.pins().vertex[0];
  for (int k = 1; k < 5; ++k) {
    CHECK(steps[k].step == k);
    const Vec2 wanted = (1 - 0.25 * k) * steps[0].uv[pin] + (0.25 * k) * steps[4].uv[pin];
    CHECK(norm(steps[k].uv[pin] - wanted) < 1e-12);
  }
}

TEST_CASE("edit: steps on the way are free of flips where the map is, and their facts are kept") {
  Scene scene;
  scene.pins().uv[2] += Vec2{0.4, 0.15};
  const auto way_of = [&](Flips flips) {
    MapEditor editor = scene.editor();
    std::vector<Certificate> seen;
    const auto sink = [&](DeformStep step) -> Result<void> {
      seen.push_back(std::move(step.certificate));
      return {};
    };
    REQUIRE(editor.solve({.steps = 6, .flips = flips}, {}, sink).has_value());
    const std::vector<StepFacts> way = editor.measure().facts.way;
    REQUIRE(way.size() == 7);
    for (std::size_t k = 0; k < way.size(); ++k) {
      CHECK(way[k].step == static_cast<int>(k));
      CHECK(way[k].arap == seen[k].arap);
      CHECK(way[k].flipped == seen[k].flipped_triangles);
      CHECK(way[k].overwound == seen[k].overwound_vertices);
    }
    return way;
  };
  const auto faults = [](const StepFacts& step) { return step.flipped + step.overwound; };
  const std::vector<StepFacts> kept = way_of(Flips::Keep), mended = way_of(Flips::Untangle);
  CHECK(faults(kept[0]) == 0);
  CHECK(std::ranges::count_if(kept, faults) > 2);
  CHECK(std::ranges::count_if(mended, faults) == 0);
  CHECK(mended.back().arap > mended.front().arap);
}

TEST_CASE("edit: what has no meaning is refused, and the editor goes on") {
  Scene scene;
  MapEditor editor = scene.editor();
  CHECK(code(editor.move_pin(scene.pins().vertex[0] + 1, {})) == ErrorCode::BadUsage);
  CHECK(code(editor.solve({.steps = 0})) == ErrorCode::BadUsage);
  CHECK(code(editor.solve({.tolerance = 0})) == ErrorCode::BadUsage);
  CHECK(code(editor.solve({.flips = Flips::Weights})) == ErrorCode::BadUsage);
  CHECK(code(editor.solve({.flips = Flips::Keep, .overlaps = Overlapping::Remove})) == ErrorCode::BadUsage);
  CHECK(editor.solve().has_value());
  const std::vector<Vec2> few(3);
  const auto begun = MapEditor::begin(scene.mesh.surface(), few);
  REQUIRE(!begun.has_value());
  CHECK(begun.error().code == ErrorCode::BadUsage);
}
