// Triangles whose shape features prescribe entirely are given a free corner before a template can turn them over.
#pragma once

#include <vector>

#include "engine/features/refined_mesh.hpp"

namespace planish {

/// A chain of prescribed shape.
struct PrescribedChain {
  In<Index> vertex;
  bool straight = false;
};

/// Splits at their midpoints: edges that join two vertices of one straight chain but are no part of a chain, and one
/// such edge of every triangle all of whose corners lie on chains. Returns the number of splits. Triangles whose
/// three edges all belong to chains stay.
/// Ref: DESIGN 3.2, feasibility refinement; more triangles than need be are freed, none is missed.
/// Cost: O(stars of the chains).
Index free_prescribed_triangles(RefinedMesh& mesh, const std::vector<PrescribedChain>& chains);

}  // namespace planish
