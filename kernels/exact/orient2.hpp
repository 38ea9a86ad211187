// Exact sign of the orientation of three points of the plane.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// +1 where a, b, c turn counter-clockwise, -1 clockwise, 0 on one line; exact for finite doubles whose
/// products neither overflow nor underflow.
/// Cost: a floating-point filter, expansions only where it cannot
/// decide.
/// Ref: Shewchuk 1997, Adaptive precision floating-point arithmetic.
int orient2(Vec2 a, Vec2 b, Vec2 c);

}  // namespace planish
