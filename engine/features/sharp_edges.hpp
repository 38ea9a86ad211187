// Creases: paths of edges at which the surface bends by more than an angle.
#pragma once

#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

struct FoundChain {
  std::vector<Index> vertex;
  bool closed = false;  ///< the last vertex is joined to the first, which is not repeated
};

/// The path of sharp edges (angle between the normals of the two triangles above the threshold; boundary
/// edges are never sharp) that holds the one nearest to a point (ties: the sharper one).
///
/// Two sharp edges that meet in a vertex continue one another where they are the only ones there; where more
/// meet, only if each is the one edge that the other reaches with a turn below 60 degrees. So a path is the
/// same whichever of its edges the point is near to. It ends where no edge continues, and before a vertex
/// that it has passed; it is closed where it comes back to its own start.
/// Open: from the lexicographically smaller end. Closed: from the vertex nearest to the point, towards the
/// lexicographically smaller neighbour. Neither depends on the numbering of the mesh.
///
/// Fails: FeatureBroken: the threshold is not in [0, 180), the point is not finite, no edge is above the
/// threshold (the sharpest angle is stated).   Cost: O(T) in parallel.
Result<FoundChain> chain_of_sharp_edges(const Exec& exec, const Surface& surface, const Topology& topology,
                                        const std::string& name, const SharpEdgesSource& source);

}  // namespace planish
