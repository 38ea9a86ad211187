// From a map whose parts lie on one another to one whose parts do not.
#pragma once

#include <memory>

#include "engine/solve/driver.hpp"
#include "engine/solve/pulled_start.hpp"

namespace planish {

/// Where a map free of overlaps may come from, cheapest first; none of them need be free of them.
struct OverlapFreeStarts {
  struct Map {
    std::vector<Vec2> uv;  ///< [V]
    std::unique_ptr<DofMap>
        dof;  ///< of the problem's unknowns; its poses put the features where they lie in it
  };
  /// The map of the first rotations.
  std::function<Result<Map>()> first_map;
  /// Without constraints: a map of any shape that has neither flips nor overlaps.
  std::function<Result<std::vector<Vec2>>()> convex_map = {};
  /// With constraints: a map without them.
  std::function<Result<std::vector<Vec2>>()> unconstrained_map = {};
  /// Where features are to lie near a map, and what the DOF map holds at 0. The DOF map is that of the last call, and outlives
  /// the removal.
  struct NearConstraints : PulledMap {
    DofMap* dof = nullptr;  ///< its poses put the features in their places
  };
  std::function<Result<NearConstraints>(std::vector<Vec2> uv)> near_constraints = {};
};

/// Takes a map that is free of flips and overlaps down to the minimum of the same energy among such maps, by Newton steps with
/// a barrier between its boundary edges. Where no start is free of overlaps the map stays as it was.
///   problem: all but its global phase;  minimum: in and out, its map injective (else nothing is done)
/// Fails: as minimise_arap(), and what the starts fail with.
/// Cost: some tens of factorizations of twice the global phase's size; where starts are far, hundreds.
Result<void> remove_overlaps(const Exec& exec, const ArapProblem& problem, const OverlapFreeStarts& starts,
                             const FlattenOptions& options, const Monitor& monitor, Minimum& minimum);

}  // namespace planish
