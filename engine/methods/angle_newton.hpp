// Newton's method on the Lagrangian of angle-based flattening.
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/methods/angle_rows.hpp"
#include "engine/model/monitor.hpp"

namespace planish {

/// Minimise sum of weight (angle - wanted)^2 where triangles sum to pi and all rows hold.
struct AngleProblem {
  In<Index> corner_vertex;
  const Topology* topology = nullptr;
  const AngleRows* rows = nullptr;
  const std::vector<LongAngleRow>* long_rows = nullptr;
  In<double> wanted;  ///< [3 T] radians
  In<double> weight;  ///< [3 T] > 0
  In<Index> order;    ///< fill-reducing, of the vertices
};

struct AngleSolution {
  std::vector<double> angle;  ///< [3 T]
  bool converged = false;
  double residual = 0;          ///< largest one of any row and triangle
  double step = 0;              ///< root mean square of the last change against the wanted angles
  double energy = 0;            ///< mean of weight (angle - wanted)^2
  std::vector<double> history;  ///< step of each iteration
};

/// From angles in (0, pi) that need meet no row. The triangles' multipliers are eliminated one by one, then the angles: what is
/// left is a positive definite system in the multipliers of the rows, as sparse as the vertices' Laplacian; long rows are its
/// dense border. Near the solution the Hessian is taken as it is where that was raised to be definite. Steps stop short of angles of 0, and are halved until a weighted sum of energy and residuals falls.
/// converged: all rows to 1e-12 or what rounding leaves below 1e-9, steps below `tolerance`.
///   start [3 T]
/// Fails: FactorizationFailed; ConstraintsConflict (ids: relations) where long rows contradict one another; OutOfMemory;
///        Cancelled.
/// Cost: a step costs one factorization of twice the vertices.
/// Ref: Sheffer et al. 2005, equations 4 to 11; the wheels in logarithms (Zayer et al. 2007: their linear system is the first
/// step from the wanted angles).
Result<AngleSolution> solve_angles(const Exec& exec, const AngleProblem& problem, std::vector<double> start,
                                   double tolerance, int max_steps, const Monitor& monitor);

}  // namespace planish
