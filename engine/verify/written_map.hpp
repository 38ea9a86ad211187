// A mesh and its parameterization as a file has them: uv a corner, several a vertex along seams.
#pragma once

#include <vector>

#include "engine/model/mesh.hpp"

namespace planish {

class WrittenMap {
 public:
  /// The arrays must outlive the map.   corner_uv [3 T].   Cost: O(V + T).
  WrittenMap(const Surface& surface, In<Vec2> corner_uv);

  Index num_vertices() const { return surface_.num_vertices(); }
  Vec3 position(Index v) const { return surface_.position[v]; }
  Index vertex(Index c) const { return surface_.corner_vertex[c]; }
  Vec2 uv(Index c) const { return corner_uv_[c]; }
  /// The corner of triangle t at vertex v.
  Index corner(Index t, Index v) const;

  /// The triangle left of a -> b, of side 2 the one right of it; where there is none, the other one; kNone where a and b
  /// share no edge.
  Index triangle_beside(Index a, Index b, int side) const;
  /// Whether the two triangles of an edge lie apart in the map.
  bool is_torn(Index a, Index b) const;

  /// The different uv of a vertex; none of an unreferenced one.
  std::vector<Vec2> images(Index v) const;
  /// Diagonal of the map's box.
  double extent() const;

 private:
  In<Index> corners_of(Index v) const;
  /// The triangle with the half-edge a -> b, or kNone.
  Index triangle_of(Index a, Index b) const;

  Surface surface_;
  In<Vec2> corner_uv_;
  std::vector<Index> star_begin_, star_corner_;
};

}  // namespace planish
