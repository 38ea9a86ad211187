// The minimum of a map energy among maps without flips and overwound vertices (DESIGN 3.6), in two steps.
#pragma once

#include "engine/solve/driver.hpp"
#include "engine/solve/map_energy.hpp"

namespace planish {

/// What is lowered among maps without flips.
inline MapDensity density_of(const FlattenOptions& options) {
  return {.kind =
              options.energy == Energy::Arap ? MapDensity::Kind::Arap : MapDensity::Kind::SymmetricDirichlet};
}

/// From where local/global steps ended (Watch::Injectivity) to a map without flips: first in patches around them, features
/// held, then of the whole with all that is free. Where vertices stay overwound, again from the very first map: what later
/// steps wound up cannot be unwound; and then from the problem's last resort. Where no map without flips is found, the one with the fewest faults stays.
/// minimum: in and out, its uv and whether they are injective.   Fails: as minimise_arap().
/// Cost: some ten factorizations of twice the global phase's size where patches do not suffice.
Result<void> remove_flips(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
                          const Monitor& monitor, Minimum& minimum);

/// From a map without flips down to the minimum, and never to a map with some: Newton steps of the whole, and in between of
/// patches around what is compressed most, until the gradient is at most options.tolerance or, with the local/global
/// steps before, options.max_iterations steps are done. No step where the minimum of ARAP keeps clear of the barrier.
/// Fails: as minimise_arap().   Cost: a factorization of twice the global phase's size a step.
Result<void> polish(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
                    const Monitor& monitor, Minimum& minimum);

}  // namespace planish
