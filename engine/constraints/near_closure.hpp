// Cycles of bodies that close but for a part of `agreement`, and templates that fold what they hold.
#pragma once

#include <functional>
#include <memory>

#include "engine/constraints/owners.hpp"

namespace planish {

/// A joint that was given up, and how far it gapes where all others close, units of the mesh here.
struct PartedJoint {
  Joint joint;
  double mismatch = 0;
};

/// Cycles of bodies that close but for the precision of the file (four sides of a square) are near agreement, too: the
/// joint that gapes most is given up, its body of lower rank yields the vertex. What gapes wider is left as it is.
///   poses: makes poses for the agreement as it is then, not closed
///   agreement, owners: in and out
/// Cost: twice that of Poses::close() a joint.
std::vector<PartedJoint> part_nearly_closed(const Compiled& compiled, double tolerance,
                                            const std::function<std::unique_ptr<Poses>()>& poses,
                                            Agreement& agreement, std::vector<Owner>& owners);

/// Triangles that have all corners on one rigid whole must keep the orientation that it gives them.
///   point [V]: where the owners' bodies lie, each rigid whole in a frame of its own
/// Fails: ConstraintsConflict, naming triangles and constraints.   Cost: O(T).
Result<void> check_folds(const RestSurface& rest, const ConstraintView& view, const Compiled& compiled,
                         const Agreement& agreement, const std::vector<Owner>& owners, In<Vec2> point);

}  // namespace planish
