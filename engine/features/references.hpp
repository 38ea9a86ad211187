// Whether the constraints of a set speak of vertices and edges that the mesh has.
#pragma once

#include "engine/model/constraint.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Fails: ConstraintInvalid: vertices that do not exist or that no triangle uses, pairs of vertices that share no
///        edge; names the constraint and its place in the file.   Cost: O(what is named).
Result<void> check_references(const Surface& surface, const Topology& topology, const ConstraintSet& set);

}  // namespace planish
