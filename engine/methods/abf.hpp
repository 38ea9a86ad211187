// Angle-based flattening: the corner angles of a flat map nearest to those of the surface.
#pragma once

#include "engine/methods/method.hpp"

namespace planish {

/// Corner angles with the least sum of ((angle - wanted) / wanted)^2 that close around every vertex; wanted are those of the
/// surface, scaled around interior vertices to sum to 2 pi. Holes are closed by triangles first, so that the flat surface closes
/// around them too; these weigh a quarter. Lines are straight by sums of angles at their vertices, relations are sums of
/// angles along strips of triangles; lengths along lines are what comes out.
/// Fails: NoConvergence naming the triangles whose angles went to 0; ConstraintsConflict; ConstraintUnsupported (chords that are
///        no edges, pins beyond a similarity); as fill_holes(), GlobalPhase::factor().
/// Cost: some 3 to 15 factorizations of twice the size of the global phase's.
/// Ref: Sheffer, Levy, Mogilnitsky and Bogomyakov 2005; Zayer, Levy and Seidel 2007; Vallet and Levy 2009 (constraints).
Result<MethodMap> angle_based_map(const MapInput& input, const Monitor& monitor);

/// Why abf cannot express a constraint, null where it can; and what it lets go: the lengths along lines.
const char* angle_refusal(const Constraint& constraint);
bool free_lengths(Constraint& constraint);

/// A circle, a curve or a region.
bool asks_for_shape(const Constraint& constraint);

/// A line of lengths by a given factor, or by one shared with others: more than being straight.
bool asks_for_lengths(const Constraint& constraint);

}  // namespace planish
