// Least squares conformal maps: two vertices of each component pinned, or those that the user pins.
#pragma once

#include "engine/methods/method.hpp"

namespace planish {

/// Two vertices of the component's outer boundary far from each other in space: from the first one to the farthest, from
/// there to the farthest, until the distance grows no more. Ties: the smaller number.
std::array<Index, 2> far_pair(const Workpiece& piece, Index component);

/// The minimum of the conformal energy over maps that meet the constraints. In components that fewer than two pins hold, the
/// difference of a far pair's images is given: where only scale and rotation are open, as if both were pinned; where
/// directions against the u axis are asked for, its part along the pair. LSCM and DNCP are this map: their energies are one.
/// Where directions of several features are tied, steps are repeated until they stand still.
/// Fails: FactorizationFailed; NoConvergence; OutOfMemory, Cancelled.
/// Cost: a factorization of four times the size of the global phase's; a further one where directions turn far.
/// Ref: Levy et al. 2002; Desbrun et al. 2002; Vaitkus and Varady, section 4.
Result<MethodMap> pinned_conformal_map(const MapInput& input, const Monitor& monitor);

}  // namespace planish
