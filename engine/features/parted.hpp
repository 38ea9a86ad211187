// Features on a surface that was cut open.
#pragma once

#include "engine/cut.hpp"
#include "engine/exec/parallel.hpp"
#include "engine/model/constraint.hpp"

namespace planish {

/// The features that constraints speak of, in the vertices of the opened surface. A chain along which the cut runs becomes
/// two features of the same name: its copy on the left (side 1) and on the right (side 2). The set's `outer` may be cut: what
/// is left of it on one side tells its loop.
/// Fails: ConstraintInvalid where a cut crosses such a chain, so that it is in pieces.   Cost: O(T).
Result<std::vector<Feature>> features_on_cut(const Exec& exec, const Surface& surface, const Cut& cut,
                                             const std::vector<Feature>& features, const ConstraintSet& set);

/// A region's template, given as a point a vertex of the opened surface, in the numbers of the surface before: a point a
/// vertex, ascending, or, where the cut runs through the region, three a triangle.
///   triangle: of the region, ascending
std::vector<Vec2> shape_before_cut(const Cut& cut, In<Index> triangle, In<Vec2> shape);

}  // namespace planish
