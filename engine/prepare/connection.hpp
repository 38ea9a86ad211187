// Rotations first: the smallest connection that closes every star and hole, and the triangle angles it
// integrates to.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/prepare/topology.hpp"
#include "engine/solve/symmetric_matrix.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// The unknown of the rotation problem and its right-hand side. Nodes: interior vertices keep their number;
/// the vertices of hole k of the mesh share node V + k; vertices of outer loops are the ground (kNone).
struct RotationRows {
  std::vector<Index> vertex_node;  ///< [V]
  Index num_nodes = 0;             ///< V + holes
  std::vector<double>
      target;  ///< [num_nodes] 2 pi - angle sum inside; 2 pi + sum (pi - angle sum) of a hole; else 0
  std::vector<Index> outer_loop;  ///< per component, the longest of its loops
};

/// Per component the loop that is its outer one: that of `chosen` (a loop or kNone) where it has it, else the longest.
/// Pre: manifold, every component has a boundary.
std::vector<Index> outer_loops(const Topology& topology, Index chosen = kNone);

/// Ref: DESIGN 3.1 rows and holes.   angle_sum [V] radians;  outer_loop: per component, empty: the longest.
/// Pre: manifold, every component has a boundary.
RotationRows rotation_rows(const Topology& topology, In<Index> corner_vertex, In<double> angle_sum,
                           In<Index> outer_loop = {});

/// Largest |row residual| of node potentials: sum over a node's edges of weight (potential - neighbour's) -
/// target.
double largest_residual(const SymmetricMatrix& laplacian, In<double> potential, In<double> target);

/// Frame angle of every triangle, radians, by walking the dual graph breadth first from each component's
/// first triangle: theta' = theta + a - a' - pi + w, w = dual_weight (potential[head] - potential[tail]).
///   potential [num_nodes], or empty for w = 0.   Cost: serial, O(T).
std::vector<double> integrate_connection(const Topology& topology, In<Index> corner_vertex,
                                         In<RestFrame> frame, const RotationRows& rows, In<double> potential,
                                         const std::function<double(Index c)>& dual_weight);

}  // namespace planish
