// The outer loop of local/global: from first rotations to a local minimum of the ARAP energy.
#pragma once

#include <vector>

#include "engine/constraints/dof_map.hpp"
#include "engine/model/error.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/solve/local_phase.hpp"

namespace planish {

/// Pairs the quasi-Newton directions remember; measured, see perf/README.md.
inline constexpr int kQuasiNewtonMemory = 3;

/// What the outer loop works with.
struct ArapProblem {
  ArapEnergy energy;
  GlobalPhase* global =
      nullptr;  ///< of the quotient Laplacian over the nodes of the DOF map; rounded after the first step
                ///< where that pays
  const Topology* topology = nullptr;
  EdgeWeight edge_weight;      ///< of that Laplacian
  DofMap* first = nullptr;     ///< of the first global step: directions as the first rotations have them
  DofMap* dof = nullptr;       ///< of all further ones; may be the same
  In<Vec2> rotation;           ///< [T] first rotations
  In<Index> order;             ///< fill-reducing order of the vertices
  In<Index> vertex_component;  ///< [V]
  Index num_components = 1;
  bool constrained = false;
};

struct Minimum {
  std::vector<Vec2> uv;  ///< [V]; the DOF map's poses are those of it
  std::vector<Iterate> history;
  bool converged = false;
  double gradient = 0;
};

/// Starts with the global solve for the first rotations, then takes quasi-Newton local/global steps until the
/// gradient (DESIGN 3.5) is at most options.tolerance or options.max_iterations steps are done. Where the
/// steps so far promise hundreds more, Newton steps take over (without constraints). The energy never rises beyond
/// rounding; with constraints every iterate meets them.
/// Fails: Cancelled, OutOfMemory, FactorizationFailed.
/// Cost: one solve and one or more local phases a step; a factorization of twice the size a Newton step.
Result<Minimum> minimise_arap(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
                              const Monitor& monitor);

}  // namespace planish
