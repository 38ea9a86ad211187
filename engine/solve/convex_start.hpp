// From a map of the whole onto a disk to one near the surface's own shape.
#pragma once

#include "engine/solve/driver.hpp"

namespace planish {

/// Unfolds a map that has a shape of its own (Tutte's) by energies that cope with any start: Newton steps away from triangles
/// without area, then down the symmetric Dirichlet energy until its gradient is at most 1e-2. What is held is moved to 0; with
/// problem.barrier the boundary does not cross itself on the way.
///   uv [V];  steps: in and out, Newton steps taken
/// Fails: Cancelled, OutOfMemory; what the energies cannot mend is left as it is.
Result<std::vector<Vec2>> unfold(const Exec& exec, const ArapProblem& problem, const Monitor& monitor,
                                 std::vector<Vec2> uv, int& steps);

}  // namespace planish
