#include "engine/constraints/directions.hpp"

#include "kernels/intrinsic/transport.hpp"
#include "tests/engine/constraints/rest.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

constexpr Index kN = 9;

/// Directions of lines along paths of a flat grid, against the first one.
std::vector<double> directions(const std::vector<std::vector<Index>>& paths) {
  const Rest rest(shapes::height_field(kN, shapes::flat, 0));
  std::vector<Feature> features;
  ConstraintSet set;
  for (const auto& path : paths) {
    const std::string name = "f" + std::to_string(features.size());
    features.push_back(rest.chain(name, path));
    set.constraints.push_back(named(name, LineConstraint{.feature = name}));
  }
  const ConstraintView view{&set, features, {}};
  const auto compiled = compile(rest.surface, view, no_map);
  REQUIRE(compiled);
  const auto agreement = agree(*compiled, view, rest.mesh());
  REQUIRE(agreement);
  return surface_directions(rest.surface, *compiled, VertexBodies(compiled->bodies), *agreement);
}

}  // namespace

TEST_CASE(
    "directions: lines that meet lie to one another as on the surface: at corners, crossings and the rim") {
  const auto row = grid_path(kN, 2, 4, 6, 4), up = grid_path(kN, 6, 4, 6, 7),
             back = grid_path(kN, 4, 7, 4, 2);
  const auto rim = grid_path(kN, 0, 0, 8, 0), inwards = grid_path(kN, 3, 0, 3, 3);
  const std::pair<std::vector<std::vector<Index>>, double> cases[] = {
      {{row, up}, kPi / 2}, {{up, row}, -kPi / 2}, {{row, back}, -kPi / 2}, {{rim, inwards}, kPi / 2}};
  for (const auto& [paths, turn] : cases) {
    const std::vector<double> direction = directions(paths);
    CHECK(std::abs(reduce_angle(direction[1] - direction[0] - turn)) < 1e-12);
  }
}

TEST_CASE("directions: they are handed on from body to body, and bodies without joints begin at 0") {
  const std::vector<double> direction = directions({grid_path(kN, 1, 1, 5, 1), grid_path(kN, 5, 1, 5, 5),
                                                    grid_path(kN, 5, 5, 2, 5), grid_path(kN, 7, 2, 7, 6)});
  CHECK(std::abs(reduce_angle(direction[1] - direction[0] - kPi / 2)) < 1e-12);
  CHECK(std::abs(reduce_angle(direction[2] - direction[0] - kPi)) < 1e-12);
  CHECK(direction[3] == 0);
}
