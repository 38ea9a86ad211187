// Discrete conformal maps by scale factors at the vertices (the Yamabe problem).
#pragma once

#include "engine/methods/method.hpp"

namespace planish {

/// The flat metric that is discretely conformal to the surface's: edge lengths l e^((u_i + u_j) / 2), angles of 2 pi inside, u = 0
/// on the outer boundary, so that its edges keep their lengths, but where lines and relations along it ask for angles. Holes are
/// closed by triangles first: u = 0 on them too would leave a turn around each that no layout closes. Where the mesh's own edges
/// do not close under any scale factors, the metric is that of the intrinsic Delaunay triangulation, flipped as u changes.
/// Fails: NoConvergence naming triangles whose edges do not close where flips do not help either; ConstraintsConflict;
///        ConstraintUnsupported (what is not on the outer boundary, pins beyond an isometry); as fill_holes(),
///        GlobalPhase::factor().
/// Cost: some 5 to 40 factorizations of the size of the global phase's.
/// Ref: Springborn, Schroeder and Pinkall 2008; Ben-Chen, Gotsman and Bunin 2008 (the first step); Gillespie, Springborn and Crane
/// 2021 (flips).
Result<MethodMap> conformal_scale_map(const MapInput& input, const Monitor& monitor);

/// Why yamabe cannot express a constraint, whatever it is on; null where that depends on it, or it can.
const char* scale_refusal(const Constraint& constraint);

}  // namespace planish
