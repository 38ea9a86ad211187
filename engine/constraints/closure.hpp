// Poses that meet all joints, or which constraints make that impossible.
#pragma once

#include "engine/constraints/poses.hpp"

namespace planish {

/// Poses with all joints met, from given directions or (fit [bodies]) near to given places; the reason where that is impossible, with a smallest set of
/// constraints that contradict one another.
/// Fails: ConstraintsConflict.   Cost: that of Poses::close(), once more for each constraint involved where it fails.
Result<std::unique_ptr<Poses>> closed_poses(const Compiled& compiled, const ConstraintView& view,
                                            const OrderedMesh& mesh, const Agreement& agreement,
                                            const Assemblies& assemblies, const Clusters& clusters,
                                            In<double> angle, In<BodyFit> fit = {});

}  // namespace planish
