// Many small features, spread over a panel: what a benchmark of constraints asks for.
#pragma once

#include <functional>

#include "engine/sample/panels.hpp"
#include "engine/sample/rows.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// Replaces the features of a sample by `count` disjoint ones, one in each cell of a grid of nearly square
/// cells: straight lines, turned from one to the next, and circles in turn, named line_0001, circle_0002, ...
///   domain   its chart in the plane, from which the cells are cut
///   surface  chart to space; points of features lie on it
/// In the chart a feature fills 0.6 of the largest disk around the middle of its cell. Distances are left 0.
/// Fails: never.  Cost: O(count).
void spread_features(const Exec& exec, const RowDomain& domain, const std::function<Vec3(Vec2)>& surface,
                     Index count, Sample& sample);

}  // namespace planish
