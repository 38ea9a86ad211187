// A short cut that turns one component into a disk, or a disk with its holes.
#pragma once

#include <vector>

#include "engine/prepare/hole_graph.hpp"

namespace planish {

/// Interior edges along which to open the component, by the smaller half-edge, in no particular order; each
/// once. What they are like is said at find_cut_graph().
///   columns: length, cost and hole are read; distance, nearest_root, arrival and parent are scratch;
///   degree, cut and side are 0 before and after
/// Reads and writes the component's part of the columns only, so components can be cut at the same time.
/// Pre: component.needs_cut(); it is a manifold.   Fails: never.   Cost: as find_cut_graph().
std::vector<Index> cut_component(const Surface& surface, const Topology& topology,
                                 const CutComponent& component, CutColumns& columns);

}  // namespace planish
