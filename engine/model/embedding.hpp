// A mesh whose edges contain the features, and where each of its elements comes from.
#pragma once

#include <vector>

#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// A point on a surface: inside a triangle, on an edge (one coordinate 0) or at a vertex (two).
struct SurfacePoint {
  Index triangle = kNone;
  Vec3 barycentric;  ///< of the triangle's corners in order; >= 0, sum 1 to rounding
};

struct Embedding {
  std::vector<Vec3> position;               ///< [V'] the input's vertices first, unchanged
  std::vector<Index> corner_vertex;         ///< [3 T']
  std::vector<Index> triangle_origin;       ///< [T'] triangle of the input that contains it
  std::vector<SurfacePoint> vertex_origin;  ///< [V' - V] of the new vertices, on the input mesh
  std::vector<Feature> features;            ///< in the order of their specs
  Index snapped_points = 0;                 ///< points moved onto a vertex or an edge nearby
  Index feasibility_splits = 0;             ///< edges split so that no triangle is forced flat (DESIGN 3.2)

  Surface surface() const { return {position, corner_vertex}; }
};

}  // namespace planish
