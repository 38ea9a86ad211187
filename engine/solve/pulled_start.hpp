// From a map without constraints to one that meets them, never crossing itself on the way.
#pragma once

#include <functional>
#include <optional>

#include "engine/solve/driver.hpp"
#include "engine/solve/map_energy.hpp"

namespace planish {

/// A vertex and its place.
using VertexPlace = std::pair<Index, Vec2>;

/// A map, and where vertices are to lie in it.
struct PulledMap {
  std::vector<Vec2> uv;            ///< [V]
  std::vector<VertexPlace> place;  ///< of some of the vertices
};
/// Moves components of a map as wholes, and says where vertices are to lie near to where they are.
using FindPlaces = std::function<Result<PulledMap>(std::vector<Vec2> uv)>;

/// Draws vertices to their places, harder and harder, while the rest of the map follows its energy, without flips and, with
/// problem.barrier, without crossing its own boundary; once they are all but there they are put there. The places are
/// found anew at every stiffness: what was in the way may have moved.
///   problem: its dof has no features;  uv [V]: without flips and overlaps
/// None where they cannot be put there without flips.   Fails: Cancelled, OutOfMemory; as find_places.
/// Cost: some tens of Newton steps.
Result<std::optional<std::vector<Vec2>>> pull_into_place(const Exec& exec, const ArapProblem& problem,
                                                         const MapDensity& density,
                                                         const FindPlaces& find_places,
                                                         const Monitor& monitor, std::vector<Vec2> uv,
                                                         int& steps);

}  // namespace planish
