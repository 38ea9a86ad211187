// A surface opened along edges: seams, and the cuts that turn it into disks.
#pragma once

#include <vector>

#include "engine/prepare/topology.hpp"

namespace planish {

/// The surface opened along edges: triangles and corners stay, vertices on the cut get copies.
struct CutSurface {
  std::vector<Vec3> position;        ///< [V'] the input's own V first, then the copies
  std::vector<Index> corner_vertex;  ///< [3 T]
  std::vector<Index> vertex_origin;  ///< [V'] vertex of the input
  Index num_cut_edges = 0;           ///< edges whose sides were parted
  double cut_length = 0;             ///< of these, mesh units

  Surface surface() const { return {position, corner_vertex}; }
};

/// Opens the surface along edges. Each fan of corners between cut or boundary edges gets a vertex: the one
/// with the smallest corner keeps the original, copies are numbered by original, then by smallest corner.
///   cut_corner: half-edges, either twin or both, repeated or not; those on the boundary are open already
/// Where a cut ends inside the surface the vertex stays one, so a lone edge between two such ends stays shut.
/// Pre: topology.manifold.   Fails: never.   Cost: O(T), parallel; the same for any number of threads.
CutSurface open_along(const Exec& exec, const Surface& surface, const Topology& topology,
                      In<Index> cut_corner);

/// Where a map is torn: a half-edge of each edge whose two triangles have different uv at one of its ends.
///   twin [3 T];  corner_uv [3 T]
std::vector<Index> torn_half_edges(In<Index> twin, In<Vec2> corner_uv);

}  // namespace planish
