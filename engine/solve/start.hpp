// First rotations of the triangles, by one of the methods of DESIGN 3.1.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/options.hpp"
#include "engine/prepare/connection.hpp"
#include "engine/prepare/topology.hpp"
#include "engine/solve/global_phase.hpp"

namespace planish {

/// What the first rotations are computed from.
struct StartInput {
  In<Index> corner_vertex;
  const Topology* topology = nullptr;
  In<RestFrame> frame;
  In<double> cotangent;
  In<double> angle_sum;       ///< [V]
  In<Index> order;            ///< fill-reducing order of the vertices
  In<Index> outer_loop = {};  ///< per component; empty: the longest of its loops
};

struct Start {
  std::vector<Vec2> rotation;     ///< [T] unit complex numbers
  std::vector<Index> outer_loop;  ///< per component
  double holonomy_residual = 0;  ///< largest residual of the rotation rows, radians; 0 where none were solved
};

/// Closest rotations of the harmonic map that takes the outer loops to circles.
Result<std::vector<Vec2>> harmonic_rotations(const Exec& exec, const StartInput& input, In<Index> outer_loop);

/// analysed: for the pattern of held_laplacian(), null: none; factored anew with the rotations' rows where these merge no vertices
/// (no holes), so that the analysis of the positions serves for them too.
/// Fails: FactorizationFailed, OutOfMemory; ResidualTooLarge where a row is missed by more than 1e-9.
Result<Start> first_rotations(const Exec& exec, const StartInput& input, Init init,
                              GlobalPhase* analysed = nullptr);

}  // namespace planish
