// Features that a person names by elements of the mesh: vertices in order, boundary loops.
// Everywhere in engine/features: the topology is that of the surface, manifold and consistently oriented;
// positions of used vertices are finite.
#pragma once

#include <string>
#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// The chain of a list of vertices: as it is, or with consecutive ones joined by shortest edge paths. No
/// vertex comes twice; a closed chain does not repeat its first. A shortest path that would meet the chain so
/// far gives way to the shortest that does not (at corners of the curve, paths often share their first edges).
/// Fails: FeatureBroken: ids that do not exist, fewer than 2 vertices (closed: 3), the first one repeated at the
/// end, any other repeated, unused ones, vertices of several components, consecutive ones that share no edge,
/// a shortest path that passes another vertex of the list, or cannot avoid the chain.
/// Cost: O(n log n) of the list; joined: the sum of the searches and 13 bytes a vertex of the mesh.
Result<std::vector<Index>> chain_of_vertices(const Surface& surface, const Topology& topology,
                                             const std::string& name, const VertexSource& source);

/// The closed chain of a boundary loop, surface on its left.
/// Fails: FeatureBroken, saying how many loops there are.
Result<std::vector<Index>> chain_of_loop(const Surface& surface, const Topology& topology,
                                         const std::string& name, const LoopSource& source);

/// The closed chain of the loop whose edges come nearest to a point (ties: the loop of the smaller number).
/// Fails: FeatureBroken: the point is not finite, the surface has no boundary.
/// Cost: O(boundary edges).
Result<std::vector<Index>> chain_of_nearest_loop(const Surface& surface, const Topology& topology,
                                                 const std::string& name, const BoundaryNearSource& source);

}  // namespace planish
