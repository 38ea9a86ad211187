// Maps that have no flips whatever the surface: Tutte's embedding.
#pragma once

#include "engine/model/error.hpp"
#include "engine/solve/start.hpp"

namespace planish {

/// Outer loops on circles of the components' areas, every other vertex in the mean of its neighbours, inner loops closed by
/// a vertex in their middle. Without flips and overwound vertices by Tutte's theorem (up to rounding, and to triangles that
/// hang on the rest by one edge of a circle); far from any isometry.
///   result [V].   Fails: as GlobalPhase::factor().   Cost: one factorization of the size of the global phase.
Result<std::vector<Vec2>> tutte_map(const Exec& exec, const StartInput& input);

}  // namespace planish
