// Triangles of a map that lie on one another.
#pragma once

#include <array>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

struct Overlaps {
  Offset pairs = 0;        ///< pairs without a common vertex whose images share interior points, exact
  double common_area = 0;  ///< sum of the pairs' common areas, squared units of uv
  double map_area = 0;     ///< sum of the triangles' image areas
  std::vector<std::array<Index, 2>>
      first;  ///< the first kMaxListedIds pairs, ascending; smaller triangle first
};

/// Bounding volume hierarchy over the image triangles, exact orientation predicates.
///   corner_vertex [3 T];  uv [V], finite.   Cost: O(T log T + candidate pairs).
Overlaps find_overlaps(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv);

/// The triangles of those pairs, ascending, each once.
std::vector<Index> overlapping_triangles(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv);

}  // namespace planish
