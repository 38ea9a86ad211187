// From a map whose parts lie on one another to one whose parts do not.
#pragma once

#include "engine/solve/driver.hpp"
#include "engine/solve/pulled_start.hpp"

namespace planish {

/// Where a map free of overlaps may come from, cheapest first; none of them need be free of them.
struct OverlapFreeStarts {
  /// The map of the first rotations, and the poses of its features set.
  std::function<Result<std::vector<Vec2>>()> first_map;
  /// Without constraints: a map of any shape that has neither flips nor overlaps.
  std::function<Result<std::vector<Vec2>>()> convex_map = {};
  /// With constraints: a map without them that is free of overlaps, where their features are to lie in it, and the DOF map
  /// whose poses put them there.
  struct NearConstraints {
    std::vector<Vec2> uv;
    std::vector<VertexPlace> place;
    DofMap* dof = nullptr;
  };
  std::function<Result<NearConstraints>()> near_constraints = {};
};

/// Takes a map of the same energy that is free of flips and overlaps down to its minimum among such maps: Newton steps of the
/// map and a scaffold of triangles around it, made anew from time to time. Where no start is free of overlaps the map stays as it was.
/// problem: all but its global phase;  minimum: in and out.   Fails: as minimise_arap(); NotBuilt.
/// Cost: some tens of factorizations of twice the global phase's size.
Result<void> remove_overlaps(const Exec& exec, const ArapProblem& problem, const OverlapFreeStarts& starts,
                             const FlattenOptions& options, const Monitor& monitor, Minimum& minimum);

}  // namespace planish
