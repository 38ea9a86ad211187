// Regions given triangle by triangle.
#pragma once

#include <string>
#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Checks a list of triangles; returns them ascending.
/// Fails: RegionBroken: none, ids that do not exist, repeated ones, not connected over edges (one triangle of each
/// piece is listed).   Cost: O(T) bytes, O(n log n) of the list.
Result<std::vector<Index>> region_of_triangles(const Surface& surface, const Topology& topology,
                                               const std::string& name, const TriangleSource& source);

}  // namespace planish
