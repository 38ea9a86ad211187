// A map moved, component by component, to where pins and directions want it as a whole.
#pragma once

#include "engine/constraints/fit.hpp"
#include "engine/constraints/system.hpp"
#include "engine/workpiece.hpp"

namespace planish {

/// What two isometries do one after the other.
Placement then(const Placement& first, const Placement& second);

/// Moves each component onto its pins (onto_pins), and turns it as its directions ask unless several pins say how it is
/// turned. Returns what moved them.
///   system: out, oriented at the map;  uv [V] in and out, units of the ordered mesh
/// Fails: as ConstraintSystem::orient_at().
Result<std::vector<Placement>> align_map(const Workpiece& piece, ConstraintSystem& system, Out<Vec2> uv);

}  // namespace planish
