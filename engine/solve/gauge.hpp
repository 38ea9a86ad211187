// Where a flattened component lies: what the energy leaves free is fixed here.
#pragma once

#include "engine/exec/parallel.hpp"

namespace planish {

/// The components of a map, and what constraints have decided about their places.
struct PlacedComponents {
  In<Index> of;               ///< [V] component of each vertex
  In<std::uint8_t> directed;  ///< per component: 1 where it must not be turned
  In<std::uint8_t> pinned;    ///< per component: 1 where it must not be moved at all
  Index size() const { return static_cast<Index>(directed.size()); }
};

/// Moves and turns the map of each component: area centroid to the origin, long axis of the area moments
/// along u, the heavier tail (third moment) towards +u; where moments decide nothing, the vertex of smallest
/// rank towards +u.
///   vertex_rank [V]: place in the caller's order;  uv [V] in and out.   Ref: DESIGN 3.4.
void centre_and_align(In<Index> corner_vertex, const PlacedComponents& components, In<Index> vertex_rank,
                      Out<Vec2> uv);

/// Lays several components out in rows, tallest first, boxes apart by a gap; the whole is centred on the
/// origin, or stands to the right of the components that are pinned.
void lay_out(const PlacedComponents& components, Out<Vec2> uv);

}  // namespace planish
