// Projected Newton on maps: away from flips, and down to a minimum without them.
#pragma once

#include <functional>

#include "engine/solve/newton_map.hpp"

namespace planish {

/// Minimises the regularised energy while epsilon goes to 0, a Newton step each, until no triangle is flipped or so many
/// steps are taken; true where none is flipped.   keep_on: asked before every step
///   Fails: as NewtonMap::prepare(), and as keep_on.   Ref: Garanzha et al. 2021.
Result<bool> untangle(NewtonMap& map, int most_steps, int& steps,
                      const std::function<Result<void>()>& keep_on);

/// Newton steps down an energy that is infinite at flips, until the gradient is at most the tolerance.
struct Descent {
  bool converged = false;
  double gradient = 0;
  int steps = 0;
};
/// watch: given the state before each step.   Fails: as NewtonMap::prepare(), and as watch.
Result<Descent> descend(NewtonMap& map, double tolerance, int most_steps,
                        const std::function<Result<void>(double gradient)>& watch);

}  // namespace planish
