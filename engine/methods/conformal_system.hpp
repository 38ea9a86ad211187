// Linear systems of the conformal energy over the unknowns of a DOF map.
#pragma once

#include <optional>

#include "engine/methods/conformal_energy.hpp"
#include "engine/solve/global_phase.hpp"

namespace planish {

/// Vectors are laid out as the DOF map's unknowns, [dof.size()].
class ConformalSystem {
 public:
  /// All must outlive the system.   diagonal [V] or empty: added to the Hessian
  ConformalSystem(const Exec& exec, const Workpiece& piece, const ConformalEnergy& energy, DofMap& dof,
                  In<double> diagonal = {})
      : exec_(exec), piece_(piece), energy_(energy), dof_(dof), diagonal_(diagonal) {}

  /// Tangents at x, expanded, and the factor of the Hessian over them.   x: in and out, its border becomes 0
  /// Fails: FactorizationFailed (not definite: something is left free), OutOfMemory.
  Result<void> factor(std::vector<Vec2>& x);

  /// Real unknowns that are left free.
  Index num_unknowns() const { return unknowns_.size; }

  /// Solutions of two systems; right-hand sides are folded forces.   a_solution, b_solution out
  void solve(In<Vec2> a, In<Vec2> b, Out<Vec2> a_solution, Out<Vec2> b_solution) const;
  void solve(In<Vec2> rhs, Out<Vec2> solution) const;

  /// How vertices move, to first order.   change: unknowns;  result [V]
  std::vector<Vec2> displacement(In<Vec2> change) const;

 private:
  /// Calls visit(unknown, value) for both coordinates of pairs, and for one of border unknowns.
  template <class Visit>
  void visit_unknowns(In<Vec2> vector, Visit visit) const;
  void scatter(In<Vec2> solved, bool second, Out<Vec2> vector) const;

  const Exec& exec_;
  const Workpiece& piece_;
  const ConformalEnergy& energy_;
  DofMap& dof_;
  In<double> diagonal_;
  ReducedUnknowns unknowns_;
  std::optional<GlobalPhase> global_;
};

}  // namespace planish
