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
  double covered_rest_area =
      0;  ///< sum of the pairs' common areas, pulled back to the rest shapes of both; 0 without these
  std::vector<std::array<Index, 2>>
      first;  ///< the first kMaxListedIds pairs, ascending; smaller triangle first
};

/// Bounding volume hierarchy over the image triangles, exact orientation predicates.
///   corner_vertex [3 T];  uv [V], finite;  rest_area [T] or none.   Cost: O(T log T + candidate pairs).
Overlaps find_overlaps(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv, In<double> rest_area = {});

/// Area that the images of two triangles have in common; 0 exactly where their interiors are disjoint.
double common_image_area(In<Index> corner_vertex, In<Vec2> uv, Index s, Index t);

/// The triangles of those pairs, ascending, each once.
std::vector<Index> overlapping_triangles(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv);

}  // namespace planish
