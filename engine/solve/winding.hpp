// How often the image of a mesh winds around its vertices.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/solve/local_phase.hpp"

namespace planish {

/// Whether each triangle of the star goes on where the one before ends, all around; those of a patch's rim are in any order.
bool is_interior(const ArapEnergy& mesh, Index v);

/// Tells maps that wind once around every interior vertex from others by their boundary alone. A horizontal line through a
/// vertex passes through as many of its corners as the image winds half turns around it; and one through a corner of a positive
/// triangle through exactly one of its three. So the triangles are as many as the half turns of all vertices together, and
/// those of the interior ones are what the boundary's corners leave. Exact: only coordinates are compared.
class Winding {
 public:
  /// Cost: O(V)
  Winding(const Exec& exec, const ArapEnergy& mesh);

  /// Pre: every triangle is positively oriented at uv [V].   Cost: O(corners at boundary vertices)
  bool is_single(In<Vec2> uv) const;

 private:
  const Exec& exec_;
  ArapEnergy mesh_;
  std::vector<Index> boundary_;  // vertices
};

/// Interior vertices around which the image winds more than once, ascending. Cost: O(T), without trigonometry.
std::vector<Index> overwound_vertices(const Exec& exec, const ArapEnergy& mesh, In<Vec2> uv);

}  // namespace planish
