// Features on a surface that was cut open.
#pragma once

#include "engine/cut.hpp"
#include "engine/model/constraint.hpp"

namespace planish {

/// The features that constraints speak of, in the vertices of the opened surface. A chain along which the cut runs becomes
/// two features of the same name: its copy on the left (side 1) and on the right (side 2).
/// Fails: ConstraintInvalid where a cut crosses such a chain, so that it is in pieces.   Cost: O(T).
Result<std::vector<Feature>> features_on_cut(const Surface& surface, const Cut& cut,
                                             const std::vector<Feature>& features, const ConstraintSet& set);

/// A region's template, given as a point a vertex of the opened surface, in the numbers of the surface before: a point a
/// vertex, ascending, or, where the cut runs through the region, three a triangle.
///   triangle: of the region, ascending
std::vector<Vec2> shape_before_cut(const Cut& cut, In<Index> triangle, In<Vec2> shape);

}  // namespace planish
