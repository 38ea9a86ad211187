// Laplacians of the mesh graph, gathered vertex by vertex.
#pragma once

#include <functional>

#include "engine/exec/parallel.hpp"
#include "engine/prepare/topology.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

/// Weight of the edge of half-edge c; the same for its twin.
using EdgeWeight = std::function<double(Index c)>;

/// Laplacian D - W over all vertices, positive semidefinite for cotangent weights; rows of `fixed` vertices
/// [V] (1 or 0) become unit rows, which makes it definite when every component has one.
/// Pre: manifold.   Cost: O(T), parallel.
SymmetricMatrix vertex_laplacian(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                 In<std::uint8_t> fixed, const EdgeWeight& weight);

/// The same with zeros in the place of what is held, so that one analysis serves for whatever is held.   held [V]
SymmetricMatrix held_laplacian(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                               In<std::uint8_t> held, const EdgeWeight& weight);

/// Laplacian of a quotient of the vertex graph: vertex v belongs to node[v] < num_nodes, or to the ground
/// (kNone). Nodes below V must be their own single vertex (node[v] == v); unused ones get unit rows. Edges
/// inside a node vanish.
/// Pre: manifold.   Cost: O(T), parallel.
SymmetricMatrix quotient_laplacian(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                   In<Index> node, Index num_nodes, const EdgeWeight& weight);

}  // namespace planish
