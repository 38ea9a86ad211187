// Procedures against flips by weights: some triangles weigh more from one global step to the next. For comparison.
#pragma once

#include "engine/solve/driver.hpp"

namespace planish {

/// Global steps until no triangle is flipped, or options.max_iterations are done. After each some weights in the energy grow
/// and the matrix is factored anew; then the local phase, which leaves the rotations of `settled` triangles [T] as they are.
/// Directions stay those of the first rotations. What grows: with Flips::Stiffening the weight of every triangle, by the
/// Laplacian of the distortion |s1 - 1| + |s2 - 1| over the triangles, at most by 5 (Bommes et al. 2009, local stiffening);
/// else that of flipped triangles, doubled (Vaitkus and Varady, 5.3.2 and 5.3.3, with elimination in the place of
/// multipliers).
/// `converged` says that no triangle is flipped; gradients are not measured (infinite).
/// Fails: Cancelled, OutOfMemory, FactorizationFailed.   Cost: a factorization a step.
Result<Minimum> weighted_global_steps(const Exec& exec, const ArapProblem& problem, In<std::uint8_t> settled,
                                      const FlattenOptions& options, const Monitor& monitor);

}  // namespace planish
