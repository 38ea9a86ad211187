#include "engine/solve/flip_free.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/solve/boundary_barrier.hpp"
#include "engine/solve/patch_work.hpp"
#include "tests/support/grid_map.hpp"

using namespace planish;

namespace {

/// All that removing flips from maps of a flat mesh needs; its first rotations lay it out without distortion.
struct FlatProblem : GridMap {
  std::vector<Vec2> rotation;
  std::optional<GlobalPhase> global;

  explicit FlatProblem(Mesh given) : GridMap(std::move(given)) {
    const In<Index> corner = piece.mesh().corner_vertex;
    for (std::size_t c = 0; c < corner.size(); c += 3) {
      const Vec2 edge = flat[corner[c + 1]] - flat[corner[c]];
      rotation.push_back((1 / norm(edge)) * edge);
    }
    global.emplace(std::move(*GlobalPhase::factor(exec, piece.laplacian_over(exec, nodes), piece.order)));
  }
  /// The boundary pinned where the mesh itself has it.
  void pin_rim() {
    const std::vector<Vec2> at = at_gauge(flat);
    for (Index v = 0; v < static_cast<Index>(rim.size()); ++v) {
      if (!rim[v]) continue;
      nodes.node[v] = kNone;
      nodes.fixed[v] = 1;
      nodes.place.emplace_back(v, at[v]);
    }
    dof = std::make_unique<DofMap>(nodes);
    global.emplace(std::move(*GlobalPhase::factor(exec, piece.laplacian_over(exec, nodes), piece.order)));
  }
  ArapProblem problem() {
    return {.energy = piece.energy(nodes.fixed),
            .global = &*global,
            .topology = &piece.topology(),
            .edge_weight = {},
            .first = dof.get(),
            .dof = dof.get(),
            .rotation = rotation,
            .order = piece.order,
            .vertex_component = piece.component,
            .turns_freely = {1}};
  }
  /// Moved so that the vertex that is held lies at 0.
  std::vector<Vec2> at_gauge(std::vector<Vec2> uv) const {
    const auto held = std::find(nodes.fixed.begin(), nodes.fixed.end(), 1) - nodes.fixed.begin();
    const Vec2 origin = uv[held];
    for (Vec2& z : uv) z = z - origin;
    return uv;
  }
  Minimum after_steps(std::vector<Vec2> uv) const {
    Minimum minimum;
    minimum.uv = at_gauge(std::move(uv));
    minimum.history = {{0, 1, 1}, {1, 0.5, 0.5}};
    return minimum;
  }
};

/// Twice around the hub, every triangle positive.
std::vector<Vec2> wound_twice(const FlatProblem& wheel) {
  std::vector<Vec2> wound;
  const Index hub = wheel.inner().vertex.front();
  for (const Vec2 z : wheel.flat) wound.push_back(multiply(z - wheel.flat[hub], z - wheel.flat[hub]));
  return wound;
}

}  // namespace

TEST_CASE("flip removal: what winds twice beside a free boundary is laid out anew, there alone") {
  FlatProblem wheel(flat_fan());
  ArapProblem problem = wheel.problem();
  problem.untangles_first_map = false;
  Minimum minimum = wheel.after_steps(wound_twice(wheel));
  REQUIRE(remove_flips(wheel.exec, problem, {}, {}, minimum));
  CHECK(minimum.injective);
  CHECK(MapEnergy(wheel.exec, problem.energy).is_injective(minimum.uv));
  CHECK(minimum.removal.overwound_before == 1);
  CHECK(minimum.removal.untangling_steps == 0);
}

TEST_CASE("flip removal: what winds twice with its rim stays so, unless it begins again at the first map") {
  FlatProblem wheel(flat_fan());
  wheel.pin_rim();
  ArapProblem problem = wheel.problem();
  problem.untangles_first_map = false;
  Minimum minimum = wheel.after_steps(wound_twice(wheel));
  REQUIRE(remove_flips(wheel.exec, problem, {}, {}, minimum));
  CHECK(!minimum.injective);
  CHECK(minimum.removal.overwound_before == 1);
  CHECK(overwound_vertices(wheel.exec, problem.energy, minimum.uv).size() == 1);

  problem.untangles_first_map = true;
  minimum = wheel.after_steps(wound_twice(wheel));
  REQUIRE(remove_flips(wheel.exec, problem, {}, {}, minimum));
  CHECK(minimum.injective);
  CHECK(MapEnergy(wheel.exec, problem.energy).is_injective(minimum.uv));
}

TEST_CASE("flip removal: the last resort is asked for a map when nothing else has led to one") {
  FlatProblem wheel(flat_fan());
  wheel.pin_rim();
  ArapProblem problem = wheel.problem();
  int asked = 0;
  problem.last_resort = [&]() -> Result<std::vector<Vec2>> {
    ++asked;
    return wheel.at_gauge(wheel.flat);
  };
  Minimum minimum = wheel.after_steps(wound_twice(wheel));
  REQUIRE(remove_flips(wheel.exec, problem, {}, {}, minimum));
  CHECK(minimum.injective);
  CHECK(asked == 0);  // the first map was good

  problem.untangles_first_map = false;
  minimum = wheel.after_steps(wound_twice(wheel));
  REQUIRE(remove_flips(wheel.exec, problem, {}, {}, minimum));
  CHECK(asked == 1);
  CHECK(minimum.injective);
}

TEST_CASE("flip removal: a map without flips is left as it is") {
  FlatProblem sheet(shapes::height_field(9, shapes::flat, 0));
  Minimum minimum = sheet.after_steps(sheet.flat);
  minimum.injective = true;
  const std::vector<Vec2> before = minimum.uv;
  REQUIRE(remove_flips(sheet.exec, sheet.problem(), {}, {}, minimum));
  CHECK(minimum.uv == before);
}

TEST_CASE("patches: where the boundary is kept apart they leave it where it is") {
  FlatProblem sheet(shapes::height_field(9, shapes::flat, 0));
  ArapProblem problem = sheet.problem();
  std::vector<Vec2> squeezed = sheet.at_gauge(sheet.flat);
  for (Vec2& z : squeezed) z = 0.3 * z;
  const auto moved_at_boundary = [&] {
    std::vector<Vec2> uv = squeezed;
    PatchWork patches(sheet.exec, problem);
    REQUIRE(patches.relax({}, 1e-3, 0, {}, uv));
    CHECK(uv != squeezed);
    Index moved = 0;
    for (Index v = 0; v < static_cast<Index>(uv.size()); ++v)
      moved += sheet.piece.topology().is_boundary(v) && uv[v] != squeezed[v];
    return moved;
  };
  CHECK(moved_at_boundary() > 0);
  const BoundaryBarrier barrier(sheet.exec, problem.energy, sheet.piece.topology(), sheet.piece.component);
  problem.barrier = &barrier;
  // Squeezed alike everywhere nothing inside wants to move, so that one vertex is moved first.
  squeezed[sheet.inner().vertex.front()] += Vec2{0.01, 0.01};
  CHECK(moved_at_boundary() == 0);
}

TEST_CASE(
    "patches: what is compressed a little is relaxed where it is a place, and left where it is the map") {
  FlatProblem sheet(shapes::height_field(41, shapes::flat, 0));
  const ArapProblem problem = sheet.problem();
  const std::vector<Vec2> flat = sheet.at_gauge(sheet.flat);
  const auto relaxed = [&](std::vector<Vec2> uv) {
    PatchWork patches(sheet.exec, problem);
    REQUIRE(patches.relax({}, 1e-3, 0, {}, uv));
    return uv;
  };
  std::vector<Vec2> everywhere = flat;
  for (Vec2& z : everywhere) z = 0.7 * z;
  CHECK(relaxed(everywhere) == everywhere);
  for (Vec2& z : everywhere) z = 0.7 * z;
  CHECK(relaxed(everywhere) != everywhere);  // below what is left nowhere
  // Squeezed by 0.7 around one vertex, and less and less away from it.
  std::vector<Vec2> place = flat;
  const Vec2 centre = flat[sheet.inner().vertex[sheet.inner().num_pairs() / 2]];
  for (Vec2& z : place) {
    const double r = norm(z - centre);
    z = centre + (1 - 0.3 * std::max(0.0, 1 - 3 * r)) * (z - centre);
  }
  const std::vector<Vec2> after = relaxed(place);
  CHECK(after != place);
  std::vector<Vec2> force(flat.size());
  MapEnergy measure(sheet.exec, problem.energy);
  CHECK(measure.evaluate({}, after, force) < 0.9 * measure.evaluate({}, place, force));
}

TEST_CASE("patches: their tolerance is that of the whole, of which they may be a small part") {
  FlatProblem sheet(shapes::height_field(17, shapes::flat, 0));
  const ArapProblem problem = sheet.problem();
  std::vector<Vec2> uv = sheet.at_gauge(sheet.flat);
  for (const Index v : sheet.inner().vertex) uv[v] = uv[v] + 0.7 * (uv[sheet.inner().vertex.front()] - uv[v]);
  const auto energy_after = [&](double whole) {
    std::vector<Vec2> relaxed = uv, force(uv.size());
    PatchWork patches(sheet.exec, problem);
    REQUIRE(patches.relax({}, 1e-2, whole, {}, relaxed));
    return MapEnergy(sheet.exec, problem.energy).evaluate({}, relaxed, force);
  };
  std::vector<Vec2> force(uv.size());
  const double before = MapEnergy(sheet.exec, problem.energy).evaluate({}, uv, force);
  CHECK(energy_after(1e9 * before) == before);  // next to such an energy nothing is left to do
  CHECK(energy_after(before) < 0.1 * before);
}
