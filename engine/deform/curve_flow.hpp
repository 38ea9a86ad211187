// The isometric curvature flow of a plane curve towards another one (DESIGN 3.7).
#pragma once

#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// The curve a step from `from` to `to`: turning angles and edge lengths have each gone the same share of their way, and
/// closed curves are closed by the smallest turns of their edges (squares weighted by length), so that lengths are those
/// asked for. Up to a rotation and a translation; at step 1 it is `to`, to the bit.
///   from, to [n >= 2, closed >= 3] corners of both curves;  step in (0, 1]
/// Where a closed curve is so nearly straight that turns do not close it, the gap is spread over its edges by length.
/// Cost: O(n); some five sweeps where it is closed.
/// Ref: Crane, Pinkall and Schroeder 2013, Robust fairing via conformal curvature flow, in its isometric form: the flow of
/// curvature integrated by a step of any size; towards a given curvature here, not to the least.
std::vector<Vec2> flow_curve(In<Vec2> from, In<Vec2> to, bool closed, double step);

}  // namespace planish
