// Curves laid in the plane by the turning of the surface strip beside them.
#pragma once

#include <optional>
#include <vector>

#include "engine/constraints/body.hpp"

namespace planish {

/// Template of a chain with its edge lengths in space and the turning angles of the surface beside it (the mean of both
/// sides; of a chain on the boundary, the one side). A closed chain's angles are changed by the least squares that
/// close it with a total turning of +2 pi or -2 pi. None where no small change closes it.
///   counter_clockwise: of a closed chain.   Ref: DESIGN 3.2, "geodesic"
std::optional<std::vector<Vec2>> geodesic_shape(const RestSurface& rest, In<Index> chain,
                                                std::optional<bool> counter_clockwise);

}  // namespace planish
