// A mesh being mended: triangles that come and go, each element knowing what of the input it stands for; and
// the mendings that need corners only.
#pragma once

#include <string_view>
#include <vector>

#include "engine/prepare/repair.hpp"
#include "kernels/base/types.hpp"

namespace planish {

struct Soup {
  std::vector<Vec3> position;
  std::vector<Index> vertex_origin;    ///< [V]
  std::vector<Index> corner_vertex;    ///< [3 T]
  std::vector<Index> corner_origin;    ///< [3 T] corner of the input, for its uv
  std::vector<Index> triangle_origin;  ///< [T] ascending

  Index num_triangles() const { return static_cast<Index>(triangle_origin.size()); }
  const Index* corners(Index t) const { return &corner_vertex[3 * static_cast<std::size_t>(t)]; }
};

Soup make_soup(const Mesh& mesh);

/// Keeps the triangles with keep[t] != 0, in order.
void keep_triangles(Soup& soup, const std::vector<char>& keep);

/// Collects what was done; kinds in the order of their first entry.
class MendingLog {
 public:
  void add(std::string_view what, Index id);
  std::vector<Mending> finish() &&;

 private:
  std::vector<Mending> mendings_;
};

/// One side of an edge: the half-edge of a corner, its ends in ascending order.
struct EdgeSide {
  Index low, high, corner;
};

/// Sides of the edges between `vertex_of` the corners, sorted: the sides of one edge stand together.
/// Triangles with two corners at one vertex are left out.
std::vector<EdgeSide> sorted_sides(In<Index> vertex_of_corner);

/// Calls body(sides) for every edge.
template <class Body>
void for_each_edge(const std::vector<EdgeSide>& sides, Body&& body) {
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    while (j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high) ++j;
    body(In<EdgeSide>(&sides[i], j - i));
  }
}

/// Sets that grow together; the root of each is its smallest member.
class Unions {
 public:
  explicit Unions(Index n);
  Index root(Index i);
  void unite(Index i, Index j);

 private:
  std::vector<Index> parent_;
};

/// What the coordinates can tell apart, as diagnose() has it. Counts in edges of the bounding box, so that
/// neither huge nor tiny coordinates overflow; where even that cannot be had, nothing compares as short or flat.
class Precision {
 public:
  explicit Precision(const Soup& soup);
  double distance(Vec3 a, Vec3 b) const { return norm(scale_ * (b - a)); }
  /// Altitudes up to this cannot be told from none: 4 ulps of the largest coordinate.
  double least_altitude() const { return least_altitude_; }
  /// False where a coordinate is no number.
  bool is_flat(Vec3 a, Vec3 b, Vec3 c) const;

 private:
  double scale_, least_altitude_;
};

/// Marks the triangles of components that hold a flat triangle and are manifold along edges and oriented.
std::vector<char> triangles_to_mend(const Soup& soup, const Precision& precision);

/// Drops triangles that name a vertex twice.
void drop_repeated(Soup& soup, MendingLog& log);

/// Drops all but the first of triangles with the same three vertices; the first too where the copies were a
/// flap of two sides: left alone it would stick out from an edge of the surface.
void drop_copies(Soup& soup, MendingLog& log);

/// Turns the smaller half of every orientable sheet that disagrees with itself.
void turn_triangles(Soup& soup, MendingLog& log);

/// Gives every fan beyond the first at a vertex a copy of it. Edges with more than two triangles stay whole.
void split_vertices(Soup& soup, MendingLog& log);

}  // namespace planish
