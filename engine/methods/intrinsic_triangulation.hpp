// Triangulations of a surface whose edges run straight across its triangles, known by their lengths alone.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// On the vertices of the surface it began as; boundary edges stay. Several edges may join two vertices, or one to itself.
struct IntrinsicTriangulation {
  std::vector<Index> corner_vertex;  ///< [3 T]
  Topology topology;                 ///< twins, stars and components; no kinds of edges, no loops
  std::vector<double> log_length;    ///< [3 T] of each half-edge

  Index num_triangles() const { return static_cast<Index>(corner_vertex.size() / 3); }
};

/// Flips edges until the triangulation is the intrinsic Delaunay one of the metric that its lengths are. The result: how many.
/// Pre: edges close in each triangle, topology as of build_topology() of a manifold.
/// Fails: NoConvergence after 1000 flips a triangle.   Cost: O(T + flips).
/// Ref: Bobenko and Springborn 2007; Fisher, Springborn, Schroeder and Bobenko 2007.
Result<Index> flip_to_delaunay(const Exec& exec, IntrinsicTriangulation& triangulation);

/// The same for the lengths l e^((u_i + u_j) / 2), whose edges need not close, by Ptolemy's relation between the lengths l: the
/// edges that result are those of the ideal hyperbolic metric that all such lengths share, so the result depends on u alone, not
/// on the flips before. Where no boundary is near, its edges close.   u [V]
/// Fails, cost: as above.   Ref: Springborn 2020; Gillespie, Springborn and Crane 2021, sections 3 and 5.
Result<Index> flip_to_delaunay(const Exec& exec, In<double> u, IntrinsicTriangulation& triangulation);

}  // namespace planish
