// Maps that cover no point twice, told by their boundary alone.
#pragma once

#include <vector>

#include "engine/prepare/topology.hpp"

namespace planish {

/// Per component: 1 where it covers no point twice for a reason that shows at its boundary: all of its triangles are
/// positive, the boundary loops neither cross nor touch themselves or one another, and one of them alone runs
/// counter-clockwise. A point has as many images as the loops together wind around it, and simple loops, all but one of
/// them clockwise, wind at most once. 0 says nothing. Exact.   Pre: a manifold with boundary; uv [V] finite.
/// Cost: O(T + B log B) for B boundary edges, parallel.
std::vector<std::uint8_t> components_covering_once(const Exec& exec, In<Index> corner_vertex,
                                                   const Topology& topology, In<Vec2> uv);

/// The same of the whole: and the boxes of components do not meet.
bool covers_once(const Exec& exec, In<Index> corner_vertex, const Topology& topology, In<Vec2> uv);

}  // namespace planish
