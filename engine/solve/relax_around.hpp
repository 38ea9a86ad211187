// A guessed map made good where it is worst, in a neighbourhood.
#pragma once

#include "engine/solve/driver.hpp"

namespace planish {

/// At most two Newton steps on the ARAP energy in so many rings of edges around vertices, the rim and what is held staying in
/// place: near a vertex that was moved the energy is far from quadratic, which steps of the whole map would have to pay for.
/// uv [V] in and out. A neighbourhood that has flips, or whose Hessian is degenerate, stays as it is.
/// Fails: OutOfMemory.   Cost: O(V) for marks, and two factorizations of the neighbourhood.
Result<void> relax_around(const Exec& exec, const ArapProblem& problem, In<Index> vertex, int rings,
                          Out<Vec2> uv);

}  // namespace planish
