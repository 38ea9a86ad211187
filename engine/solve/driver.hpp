// The outer loop of local/global: from first rotations to a local minimum of the ARAP energy.
#pragma once

#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/solve/local_phase.hpp"

namespace planish {

/// Pairs the quasi-Newton directions remember; measured, see perf/README.md.
inline constexpr int kQuasiNewtonMemory = 6;

struct Minimum {
  std::vector<Vec2> uv;  ///< [V]
  std::vector<Iterate> history;
  bool converged = false;
  double gradient = 0;
};

/// Starts with the global solve for `rotation` [T], then iterates until the gradient (DESIGN 3.5) is at most
/// options.tolerance or options.max_iterations steps are done. The energy never rises
/// beyond rounding.
/// Fails: Cancelled.   Cost: one solve and one or more local phases a step.
Result<Minimum> minimise_arap(const Exec& exec, const ArapEnergy& energy, const GlobalPhase& global,
                              In<Vec2> rotation, const FlattenOptions& options, const Monitor& monitor,
                              int memory = kQuasiNewtonMemory);

}  // namespace planish
