// Where a flattened component lies: what the energy leaves free is fixed here.
#pragma once

#include "engine/exec/parallel.hpp"

namespace planish {

/// Moves and turns the map of each component: area centroid to the origin, long axis of the area moments
/// along u, the heavier tail (third moment) towards +u; where moments decide nothing, the vertex of smallest
/// rank towards +u.
///   vertex_component [V];  vertex_rank [V]: place in the caller's order;  uv [V] in and out.   Ref:
///   DESIGN 3.4.
void centre_and_align(In<Index> corner_vertex, In<Index> vertex_component, Index num_components,
                      In<Index> vertex_rank, Out<Vec2> uv);

/// Lays several components out in rows, tallest first, boxes apart by a gap; the whole is centred on the
/// origin.
void lay_out(In<Index> vertex_component, Index num_components, Out<Vec2> uv);

}  // namespace planish
