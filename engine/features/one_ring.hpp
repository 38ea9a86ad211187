// The edges around a vertex, and the half-edge between two vertices.
#pragma once

#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Calls body(w) for every vertex w that shares an edge with v, counter-clockwise; none where v is unused.
template <class Body>
void for_each_neighbour(const Surface& surface, const Topology& topology, Index v, Body&& body) {
  for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
    body(surface.corner_vertex[next_corner(c)]);
    const Index incoming = previous_corner(c);
    if (topology.corner_twin[incoming] == kNone) body(surface.corner_vertex[incoming]);
  }
}

/// The half-edge from one vertex to another, kNone where no triangle has it (it may have its twin).
/// Cost: O(star of tail).
inline Index half_edge(const Surface& surface, const Topology& topology, Index tail, Index head) {
  for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(tail))) {
    if (surface.corner_vertex[next_corner(c)] == head) return c;
  }
  return kNone;
}

inline bool share_edge(const Surface& surface, const Topology& topology, Index a, Index b) {
  return half_edge(surface, topology, a, b) != kNone || half_edge(surface, topology, b, a) != kNone;
}

}  // namespace planish
