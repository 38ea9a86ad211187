// The defects of DESIGN 7 in an ordered mesh, reported with the input's ids.
#pragma once

#include "engine/prepare/order.hpp"
#include "engine/prepare/topology.hpp"
#include "engine/prepare/validate.hpp"

namespace planish {

/// Fills boundary_edges, euler, genus and defects.
/// Components that are manifold and orientable by themselves are looked at for boundary and handles whatever
/// the others are.
/// Cost: O(T).
void find_defects(const Exec& exec, const OrderedMesh& mesh, const Topology& topology, Diagnosis& diagnosis);

}  // namespace planish
