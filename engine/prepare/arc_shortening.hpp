// The arcs of a cut graph, replaced by shorter ones while there are any.
#pragma once

#include "engine/prepare/cut_edges.hpp"

namespace planish {

/// Replaces arcs of a graph that opens a component. Without one of its arcs the opened surface is an annulus
/// (with holes); the shortest path across that, from one border to the other, opens it again.
///   columns: cost is read; distance, arrival and side are scratch; side is 0 before and after
/// Pre: edges is pruned, and opens the component to one piece of genus 0.   Fails: never; it ends after a
/// number of rounds, and of steps a triangle, that few meshes need.
/// Cost: for each arc, the length of the borders and a search as far as the arc is long.
void shorten_arcs(const HoleGraph& graph, const CutComponent& component, CutColumns& columns,
                  CutEdges& edges);

}  // namespace planish
