// Templates of regions: isometric unrollings, or their own flattenings where they are not developable.
#pragma once

#include <functional>

#include "engine/constraints/body.hpp"
#include "engine/model/error.hpp"

namespace planish {

/// A flip-free map of a surface, one point a vertex, in its units: what is asked of a region that does not unroll.
using RegionMap = std::function<Result<std::vector<Vec2>>(const Surface& region)>;

/// body: triangle and size are set; vertex (ascending by the numbers of the input), shape and planarity are filled in.
/// Where every interior angle defect is below 1e-10 the triangles are unrolled one by one, which is exact to rounding;
/// else `map` is called.
/// Fails: ConstraintsConflict: holonomy above 1e-3 around one of its loops (it is a tube: a seam is needed);
///        what map fails with.
Result<void> make_region(const RestSurface& rest, const ConstraintSet& set, const RegionMap& map, Body& body);

}  // namespace planish
