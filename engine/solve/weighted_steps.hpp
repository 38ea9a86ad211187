// The paper's own procedure against flips: flipped triangles weigh more from one global step to the next.
#pragma once

#include "engine/solve/driver.hpp"

namespace planish {

/// Global steps until no triangle is flipped, or options.max_iterations are done. After each the weight of flipped
/// triangles in the energy is doubled and the matrix factored anew; then the local phase, which leaves the rotations of
/// `settled` triangles [T] as they are. Directions stay those of the first rotations.
/// `converged` says that no triangle is flipped; gradients are not measured (infinite).
/// Fails: Cancelled, OutOfMemory, FactorizationFailed.   Cost: a factorization a step.
/// Ref: Vaitkus and Varady, 5.3.2 and 5.3.3, with elimination in the place of multipliers.
Result<Minimum> weighted_global_steps(const Exec& exec, const ArapProblem& problem, In<std::uint8_t> settled,
                                      const FlattenOptions& options, const Monitor& monitor);

}  // namespace planish
