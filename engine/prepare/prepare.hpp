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

}  // namespace planish
