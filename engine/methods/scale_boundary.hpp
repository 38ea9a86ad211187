// Boundary conditions of discrete conformal maps: u = 0 where nothing is asked for, else angles.
#pragma once

#include "engine/constraints/system.hpp"
#include "engine/methods/conformal_scales.hpp"
#include "engine/methods/filled_surface.hpp"

namespace planish {

/// Interior vertices: angles of 2 pi. The outer boundary: u = 0, so that its edges keep their lengths, but for inner vertices of
/// lines, which have angles of pi, and vertices between lines that a relation ties, which share one u and have a given sum of
/// angles. relations: chosen [relations] radians in the turn of a map with these sums of angles at the vertices [V]; empty: lines alone.
/// A component keeps one vertex with u = 0: where all its boundary is asked for, the last relation is left out, as it follows
/// from the others.
/// Fails: ConstraintsConflict where relations ask for the angles at one vertex twice.
Result<ScaleNodes> scale_nodes(const FilledSurface& filled, const ConstraintView& view,
                               const Compiled& compiled, In<double> chosen, In<double> angle_sum);

/// Fails: ConstraintUnsupported where a constraint is not one of the outer boundary's angles, with the reason.
Result<void> check_on_boundary(const FilledSurface& filled, const ConstraintView& view,
                               const Compiled& compiled);

}  // namespace planish
