// Regions given as one side of a closed chain.
#pragma once

#include <string>
#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// The triangles on one side of a closed chain, ascending: those that are connected over edges off the chain.
///
/// With a seed: the side of the triangle nearest to it, whichever side that is. Without: of the left and the
/// right of the chain the one of smaller area. A chain that runs along boundary only has one side, the whole
/// component: taken without a seed where the chain is the component's longest loop (its rim); the loop of a
/// hole needs a seed to mean that.
///   chain: vertices, consecutive ones (closed) share an edge; no vertex twice
/// Fails: RegionBroken: the chain is open, too short or has a gap; its left and right are connected around
/// it; the seed is not finite, nearest to the chain itself, or on another component; without a seed: both
/// sides have the same area, the smaller is in several pieces (where the chain touches the boundary), the
/// chain is the loop of a hole.
/// Cost: O(T), 4 bytes a triangle.
Result<std::vector<Index>> enclosed_triangles(const Surface& surface, const Topology& topology,
                                              const std::string& name, In<Index> chain, bool closed,
                                              const EnclosedBySource& source);

}  // namespace planish
