// From a caller's mesh to what the solver works on: ordered, with its adjacency, and checked.
#pragma once

#include "engine/prepare/order.hpp"
#include "engine/prepare/topology.hpp"
#include "engine/prepare/validate.hpp"

namespace planish {

struct PreparedMesh {
  OrderedMesh mesh;
  Topology topology;
  Diagnosis diagnosis;  ///< duplicate_positions are counted only where there are several components
};

/// Fails: IndexOutOfRange, TooLarge. Defects are in the diagnosis, not an error here.
Result<PreparedMesh> prepare(const Exec& exec, const Surface& surface);

/// The adjacency of a surface that can carry features and be cut, in its own numbers: check_manifold() and build_topology() at
/// the cost of the latter where nothing is wrong.   Fails: as check_manifold().
Result<Topology> manifold_topology(const Exec& exec, const Surface& surface);

}  // namespace planish
