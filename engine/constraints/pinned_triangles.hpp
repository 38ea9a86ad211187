// Triangles whose corners all have given places.
#pragma once

#include "engine/constraints/owners.hpp"

namespace planish {

/// Triangles with all corners pinned, or on bodies that pins leave no freedom, lie as these places have them.
/// poses: at the origin of their free coordinates.
/// Fails: ConstraintsConflict where such a triangle is turned over or flat; names pins, constraints and triangles.
/// Cost: O(T).
Result<void> check_pinned_triangles(const RestSurface& rest, const ConstraintView& view,
                                    const Compiled& compiled, const std::vector<Owner>& owners,
                                    const Assemblies& assemblies, const Poses& poses);

}  // namespace planish
