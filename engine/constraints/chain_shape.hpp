// Templates of curves: straight lines, circles and arcs, curves that keep their shape (DESIGN 3.2).
#pragma once

#include "engine/constraints/body.hpp"
#include "engine/constraints/chirality.hpp"
#include "engine/model/error.hpp"

namespace planish {

/// What the template of one curve is made from.
struct ChainInput {
  const RestSurface* rest = nullptr;
  const ConstraintSet* set = nullptr;
  Index constraint = kNone;
  const Feature* chain = nullptr;
  Chirality* chirality = nullptr;
};

/// body: vertex, closed, size are set; shape and what belongs to it is filled in.
/// Fails: ConstraintInvalid (options that do not fit the chain, too few vertices, a closed chain that does not part the
///        surface); ConstraintsConflict (a closed chain to a line, edges that no circle takes, a geodesic that does not
///        close).
Result<void> make_line(const ChainInput& input, const LineConstraint& rule, Body& body);
Result<void> make_circle(const ChainInput& input, const CircleConstraint& rule, Body& body);
Result<void> make_curve(const ChainInput& input, const CurveConstraint& rule, Body& body);

/// Lengths of a chain's edges in space, the closing one last.
std::vector<double> edge_lengths(const RestSurface& rest, In<Index> chain, bool closed);

/// Moves points so that their mean is the origin.
void centre(std::vector<Vec2>& shape);

}  // namespace planish
