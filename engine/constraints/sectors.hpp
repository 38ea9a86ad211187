// Sectors: the fans of corners between prescribed edges, each with a row of its own in the rotation problem.
#pragma once

#include "engine/constraints/layout.hpp"
#include "engine/model/error.hpp"

namespace planish {

/// The surface opened along fixed edges. A sector is a maximal fan of corners at a vertex between fixed edges or the
/// boundary; at a vertex without any it is the whole star, numbered as the vertex. Vertices with all their edges fixed
/// and none on the boundary keep one sector without a row.
struct Sectors {
  Topology opened;  ///< corner_twin kNone across fixed edges; stars [num_sectors] are those of sectors
  std::vector<Index> corner_sector;  ///< [3 T]
  std::vector<Index> vertex;         ///< [num_sectors]
  std::vector<Index> from,
      to;  ///< [num_sectors] vertices at the ends of its fixed edges, counter-clockwise; kNone: free
  std::vector<std::uint8_t> rowless;  ///< [num_sectors] 1: no edge of it is free
  Index num_vertices = 0;
  Index num_sectors() const { return static_cast<Index>(vertex.size()); }
  bool is_prescribed(Index s) const { return from[s] != kNone && to[s] != kNone; }
};

/// Pre: the layout's fixed edges are those of the topology's mesh.   Cost: O(T).
Sectors find_sectors(const Topology& topology, In<Index> corner_vertex, In<std::uint8_t> fixed_edge);

/// The fill-reducing order of the vertices as one of the sectors: those of a vertex stand together.
std::vector<Index> sector_order(const Sectors& sectors, In<Index> vertex_order);

/// Image angle of a prescribed sector, in (0, 2 pi]: from its first fixed edge counter-clockwise to its last one.
///   angle_sum: of its corners on the surface, which decides where the edges coincide
double prescribed_angle(const Layout& layout, const Sectors& sectors, Index sector, double angle_sum);

}  // namespace planish
