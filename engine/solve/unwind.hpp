// Vertices around which a map winds twice, though all triangles are positive: no steps that keep them so undo that.
#pragma once

#include "engine/solve/local_phase.hpp"

namespace planish {

/// Puts the free vertices in so many rings of edges around the given ones where each is in the middle of its neighbours
/// (Tutte's embedding of the neighbourhoods, rims as they are); triangles may be flipped then. What is held all around winds as
/// often as its rim, wherever the vertices are: it helps near boundaries that are free.   uv [V] in and out;  vertex: overwound ones
/// Cost: O(V) for marks, and some hundred sweeps over the neighbourhoods.
void unwind(const ArapEnergy& mesh, In<Index> vertex, int rings, Out<Vec2> uv);

}  // namespace planish
