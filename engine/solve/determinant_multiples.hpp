// How much of det J to add to ARAP before its Hessian is projected triangle by triangle.
#pragma once

#include <vector>

#include "engine/solve/local_phase.hpp"

namespace planish {

/// Multiples of det J, [T]: 2, with which ARAP is convex in every triangle compressed to no less than |p| = 1/2, so that
/// nothing is lost by the projection; falling to 0 within a few rings of where the boundary is free, for there the sum of det J
/// moves along. What neighbours differ by is added to the Hessian.
/// Ref: null Lagrangians (Ball 1976, Convexity conditions in nonlinear elasticity).   Cost: O(T).
std::vector<double> determinant_multiples(const ArapEnergy& mesh);

}  // namespace planish
