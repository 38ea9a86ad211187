// The surface as its map shows it: opened where the map is torn.
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Triangles as in the file; vertices are the used ones, with a copy for each part of a star that lies apart.
struct FlatSurface {
  std::vector<Vec3> position;        ///< [V'] mesh units
  std::vector<Index> corner_vertex;  ///< [3 T]
  std::vector<Vec2> uv;              ///< [V']
  std::vector<Index> origin;         ///< [V'] vertex of the file
  Topology topology;
  Index torn_edges = 0;

  Surface surface() const { return {position, corner_vertex}; }
};

/// Parts the surface along the edges whose two triangles have different uv at one of its ends. Both ends of an edge that is
/// whole have one uv, so each part of a star has one, even where copies lie on one another.
/// Pre: an oriented manifold.   corner_uv [3 T].   Cost: O(T), parallel.
FlatSurface open_where_torn(const Exec& exec, const Surface& surface, In<Vec2> corner_uv);

}  // namespace planish
