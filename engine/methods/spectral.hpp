// Spectral conformal maps: the shape of least conformal energy for its boundary's mass, without pins.
#pragma once

#include "engine/methods/method.hpp"

namespace planish {

/// Minimum of E(z) / B(z) in each component, E the conformal energy, B(z) the sum over boundary vertices of b_v |z_v - mean|^2
/// with b_v half the length of the boundary edges at v: the smallest eigenvector that is not constant. Found by steps
/// -(H + sigma B)^-1 (H z - lambda B z), each followed by the best combination with the step before; all steps stay within the
/// DOF map, so constraints hold in the result. Components whose features' directions are tied to one another minimise together the
/// sum of E / B times the length of the boundary.
/// Fails: NoConvergence where steps do not come to rest (1e-9 of the map; rounding on large meshes), or constraints leave fewer than two unknowns;
/// FactorizationFailed, OutOfMemory, Cancelled.
/// Cost: a factorization of four times the size of the global phase's, 5 to 50 solves; further ones where directions turn.
/// Ref: Mullen et al. 2008; Knyazev 2001 (locally optimal steps).
Result<MethodMap> spectral_map(const MapInput& input, const Monitor& monitor);

}  // namespace planish
