// The outer loop of local/global: from first rotations to a local minimum of the ARAP energy.
#pragma once

#include <functional>
#include <vector>

#include "engine/constraints/dof_map.hpp"
#include "engine/exec/vector_pool.hpp"
#include "engine/model/error.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/solve/local_phase.hpp"

namespace planish {

/// Pairs the quasi-Newton directions remember; measured, see perf/README.md.
inline constexpr int kQuasiNewtonMemory = 3;

class BoundaryBarrier;

/// What the outer loop works with.
struct ArapProblem {
  ArapEnergy energy;
  GlobalPhase* global =
      nullptr;  ///< of the quotient Laplacian over the nodes of the DOF map; rounded after the first step
                ///< where that pays
  const Topology* topology = nullptr;
  EdgeWeight edge_weight;   ///< of that Laplacian
  DofMap* first = nullptr;  ///< of the first global step: directions as the first rotations have them
  DofMap* dof = nullptr;    ///< of all further ones; may be the same
  In<Vec2> rotation;        ///< [T] first rotations
  /// [first->size()] unknowns near the first map, for a rounded factor to reach it in one solve; empty: none are known.
  In<Vec2> near = {};
  bool begins_near = false;    ///< at `near` itself, in dof's unknowns, without the first global step
  In<Index> order;             ///< fill-reducing order of the vertices
  In<Index> vertex_component;  ///< [V]
  Index num_components = 1;
  /// A map without flips [V], where there is one.
  std::function<Result<std::vector<Vec2>>()> last_resort = {};
  int most_untangling_steps = 100;  ///< of the whole, from one map
  bool untangles_first_map =
      true;  ///< where the last map cannot be untangled; false: another problem is tried then
  const BoundaryBarrier* barrier =
      nullptr;                  ///< where flip-free steps must not make the boundary cross itself
  LocalPhase* local = nullptr;  ///< of that energy, where one is kept from solve to solve
  VectorPool* pool = nullptr;   ///< where memory is
  std::vector<std::uint8_t> turns_freely = {};  ///< per component: 1 where nothing says how it is turned
  bool constrained = false;
  bool newton_fits = true;  ///< memory allows Newton steps
};

/// When the outer loop ends before the tolerance is met.
enum class Watch {
  None,
  /// For maps without flips: before a step that would flip a triangle of such a map or overwind a vertex of it, and where
  /// Newton steps promise to be faster. For others: as soon as the gradient is small enough for the removal of flips to
  /// begin.
  Injectivity
};

struct Minimum {
  std::vector<Vec2> uv;  ///< [V]; the DOF map's poses are those of it
  std::vector<Iterate> history;
  bool converged = false;
  /// No flipped triangle, no overwound vertex, lines keep their order; looked at with Watch::Injectivity.
  bool injective = false;
  double gradient = 0;
  FlipRemoval removal;
  OverlapRemoval overlaps;
};

/// Starts with the global solve for the first rotations, then takes quasi-Newton local/global steps until the
/// gradient (DESIGN 3.5) is at most options.tolerance or options.max_iterations steps are done. Where the
/// steps so far promise hundreds more, Newton steps take over (without constraints). The energy never rises beyond
/// rounding; with constraints every iterate meets them.
/// Fails: Cancelled, OutOfMemory, FactorizationFailed.
/// Cost: one solve and one or more local phases a step; a factorization of twice the size a Newton step.
Result<Minimum> minimise_arap(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
                              const Monitor& monitor, Watch watch = Watch::None);

}  // namespace planish
