// The surface that is flattened, as every step works on it: ordered, measured, its loops and its elimination order known.
#pragma once

#include "engine/constraints/body.hpp"
#include "engine/constraints/dof_map.hpp"
#include "engine/prepare/geometry.hpp"
#include "engine/solve/driver.hpp"
#include "engine/solve/start.hpp"

namespace planish {

struct Workpiece {
  PreparedMesh prepared;
  Geometry geometry;
  std::vector<Index> component;   ///< [V]
  std::vector<Index> outer_loop;  ///< per component
  std::vector<Index> loop_of;     ///< [V] boundary loop, kNone inside; filled where there are constraints
  std::vector<Index> order;       ///< [V] fill-reducing; filled by the step that finds it

  const OrderedMesh& mesh() const { return prepared.mesh; }
  const Topology& topology() const { return prepared.topology; }
  double edge_weight(Index c) const { return geometry.edge_weight(topology(), c); }

  void find_loops();
  RestSurface rest() const { return {&mesh(), &topology(), geometry.frame, outer_loop, loop_of}; }
  StartInput start_input() const;

  /// Cotangent Laplacian over the nodes of a DOF map, and over all vertices whatever constraints merge.
  SymmetricMatrix laplacian_over(const Exec& exec, const NodeMap& nodes) const;
  SymmetricMatrix whole_laplacian(const Exec& exec) const;
  /// The same with unit rows of held vertices [V], in the pattern of all.
  SymmetricMatrix held_laplacian(const Exec& exec, In<std::uint8_t> held) const;
  /// Nodes beyond the vertices are eliminated last.
  Result<GlobalPhase> factor(const Exec& exec, const SymmetricMatrix& laplacian) const;

  /// fixed [V]: outlives the energy, as the workpiece does.
  ArapEnergy energy(In<std::uint8_t> fixed) const;
  /// All arguments must outlive the problem, and so must the workpiece.
  ArapProblem problem(GlobalPhase& global, const NodeMap& nodes, DofMap& first, DofMap& dof,
                      In<Vec2> rotation) const;
};

/// Checks and measures.   Fails: IndexOutOfRange, TooLarge, the defects of diagnose().
Result<Workpiece> make_workpiece(const Exec& exec, const Surface& surface);

}  // namespace planish
