// Discrete conformal scale factors: the flat metric with edge lengths l e^((u_i + u_j) / 2).
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/methods/intrinsic_triangulation.hpp"
#include "engine/model/error.hpp"
#include "engine/model/monitor.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Which scale factors are unknown, and what the angles sum to there.
struct ScaleNodes {
  std::vector<Index>
      node;             ///< [V] v: its own unknown; V + k: shared by all vertices of node V + k; kNone: u = 0
  Index num_nodes = 0;  ///< V + shared ones
  std::vector<double> target;  ///< [num_nodes] sum of the angles around the node's vertices, radians
};

struct ScaleProblem {
  In<Index> corner_vertex;
  const Topology* topology = nullptr;
  In<double> log_length;  ///< [3 T] of each half-edge
  const ScaleNodes* nodes = nullptr;
  In<Index> order;  ///< fill-reducing, of the vertices
};

struct ScaleSolution {
  std::vector<double> u;      ///< [V]
  std::vector<double> angle;  ///< [3 T] radians
  std::vector<Index> broken;  ///< triangles whose edges do not close, ascending
  bool converged = false;
  double defect = 0;            ///< largest |angle sum - target| of a node, radians
  std::vector<double> history;  ///< of each step
};

/// E(u) = sum over triangles of (sum of (angle - pi / 2) * log length + L(angle)) + sum of target * u / 2: convex, with
/// gradient (target - angle sum) / 2 and Hessian half the cotangent Laplacian. It does not jump where an edge is flipped by
/// Ptolemy's relation between triangles with one circumcircle.   u [V]
/// Ref: Springborn, Schroeder and Pinkall 2008, equations 9 to 13; Springborn 2020, section 4.
double conformal_energy(const Exec& exec, const ScaleProblem& problem, In<double> u);

/// Newton's method from u = 0; its first step is the linear one of Ben-Chen et al. 2008. Triangles whose edges do not close take
/// part by the convex extension of the energy.
/// converged: every defect at most 1e-9, no triangle broken; steps go on to what rounding leaves, or `max_steps`.
/// Fails: FactorizationFailed, OutOfMemory, Cancelled.   Cost: a factorization of the size of the global phase a step.
Result<ScaleSolution> solve_scales(const Exec& exec, const ScaleProblem& problem, int max_steps,
                                   const Monitor& monitor);

/// The same where at every step the edges are those of the Delaunay triangulation under u: the energy stays convex and twice
/// differentiable, and triangles without a boundary edge never break.
///   triangulation in and out: the Delaunay one of its lengths; of the solution, whose angles are those of its corners
/// Fails: as above; NoConvergence (flips).   Cost: as above; where edges were flipped, their order is analysed again.
/// Ref: Springborn 2020; Gillespie, Springborn and Crane 2021.
Result<ScaleSolution> solve_scales(const Exec& exec, IntrinsicTriangulation& triangulation,
                                   const ScaleNodes& nodes, In<Index> order, int max_steps,
                                   const Monitor& monitor);

}  // namespace planish
