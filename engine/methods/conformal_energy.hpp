// The conformal energy of a map: half its Dirichlet energy less its area, zero where the map keeps angles.
#pragma once

#include "engine/solve/reduced_hessian.hpp"
#include "engine/workpiece.hpp"

namespace planish {

/// E(z) = 1/2 sum over edges of w |z_i - z_j|^2 - area of the map = sum over triangles of A_t (s1 - s2)^2 / 2, w the
/// cotangent weights. The area is a sum over boundary edges, so the Hessian is the Laplacian once for u and once for v, with
/// one number between them at each boundary edge: a Hermitian matrix. Boundaries are natural.
/// Ref: Levy et al. 2002 (half of eq. 5's energy); Desbrun et al. 2002, section 4; Mullen et al. 2008, eq. 4.
class ConformalEnergy {
 public:
  /// A further edge between two vertices, of a weight of its own.
  struct Spring {
    Index a = kNone, b = kNone;
    double weight = 1;
  };

  /// piece outlives the energy.   springs: at most one a vertex
  ConformalEnergy(const Exec& exec, const Workpiece& piece, const std::vector<Spring>& springs = {});

  /// Without springs.   uv [V];  force [V] out: the gradient.   Cost: O(T), parallel.
  void forces(In<Vec2> uv, Out<Vec2> force) const;
  /// Not divided by the area.
  double value(In<Vec2> uv) const;

  /// The Hessian over the unknowns, springs included.   diagonal [V] or empty: added to both unknowns of a vertex
  /// Cost: O(T) and O(m^2) at edges between vertices with m moves, parallel but for these.
  SymmetricMatrix hessian(const ReducedUnknowns& unknowns, In<double> diagonal) const;

 private:
  /// Calls visit(w, entry): Hessian between v's column and w's row, a complex number.
  template <class Visit>
  double visit_row(Index v, Visit visit) const;

  const Exec& exec_;
  const Workpiece& piece_;
  std::vector<Spring> springs_;
  std::vector<Index> spring_at_;  // [V] or empty
};

}  // namespace planish
