// Newton steps on the ARAP energy, for minima that local/global steps approach too slowly.
#pragma once

#include <optional>
#include <vector>

#include "engine/solve/global_phase.hpp"
#include "engine/solve/local_phase.hpp"
#include "kernels/local/proxy.hpp"

namespace planish {

/// Half the Hessian over the unknowns u_0, v_0, u_1, v_1, ... at uv; rows with held [2 V] = 1 become unit
/// rows. Cost: O(T), parallel.
SymmetricMatrix arap_hessian(const Exec& exec, const ArapEnergy& energy, In<Vec2> uv, In<std::uint8_t> held,
                             Convexity convexity);

/// Directions from the true Hessian where it is positive definite, else from its projection; one analysis for
/// all.
class NewtonDirections {
 public:
  /// vertex_order: fill-reducing order of the vertices.  vertex_component [V], num_components.
  NewtonDirections(const Exec& exec, const ArapEnergy& energy, In<Index> vertex_order,
                   In<Index> vertex_component, Index num_components);

  /// direction [V] out: -H^-1 force at uv; 0 at fixed vertices, and where a component has one alone at one more coordinate,
  /// far from it, so that the rotation is fixed too.   Pre: every component has a fixed vertex.
  /// Fails: OutOfMemory, FactorizationFailed.
  /// Cost: one or two factorizations, 4 times the size of the global phase's.
  Result<void> direction(In<Vec2> uv, In<Vec2> force, Out<Vec2> direction);

 private:
  std::vector<std::uint8_t> held_coordinates(In<Vec2> uv) const;
  Result<void> factor(const SymmetricMatrix& hessian);

  const Exec& exec_;
  ArapEnergy energy_;
  std::vector<Index> order_;  // of the 2 V unknowns
  In<Index> vertex_component_;
  Index num_components_;
  std::optional<GlobalPhase> global_;
};

}  // namespace planish
