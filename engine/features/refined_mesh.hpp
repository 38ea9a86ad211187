// A mesh whose triangles are cut into smaller ones without moving the surface: the edges of curves are split in, one
// by one, and every vertex knows where on the input it lies.
#pragma once

#include <unordered_map>
#include <vector>

#include "engine/model/embedding.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// Grows from an input mesh by splitting edges and triangles. Whether a piece has positive area is decided exactly,
/// in barycentric coordinates of the input triangle that contains it; a split that would leave a piece without is
/// not made. Parameters along input edges are multiples of 2^-53, so that points on an edge are exactly on one line
/// in the coordinates of both its triangles.
/// Triangles and vertices of the input keep their numbers; a triangle's number stays with one of its pieces.
class RefinedMesh {
 public:
  /// Pre: topology is that of origin, and manifold. Both must outlive the object.
  RefinedMesh(const Surface& origin, const Topology& topology);

  Index num_vertices() const { return static_cast<Index>(position_.size()); }
  Index num_input_vertices() const { return origin_.num_vertices(); }
  Index num_triangles() const { return static_cast<Index>(triangle_origin_.size()); }
  Index vertex(Index corner) const { return corner_vertex_[corner]; }
  Index twin(Index corner) const { return corner_twin_[corner]; }
  Vec3 position(Index v) const { return position_[v]; }
  Index triangle_origin(Index t) const { return triangle_origin_[t]; }
  /// Length below which two places of an input triangle count as one: `share` of its shortest edge.
  double tolerance(Index input_triangle, double share) const;

  /// Calls visit(c) for every corner c at v until it returns true; tells whether it did.
  template <class Visit>
  bool visit_star(Index v, Visit visit) const;

  /// A corner whose half-edge joins u and v in either direction, or kNone.
  Index edge_between(Index u, Index v) const;

  /// The vertex at a point of the input mesh: an existing one within tolerance, else a new one on an edge within
  /// tolerance, else a new one inside a triangle. tolerance: mesh units. `snapped` tells whether the point was moved.
  Index insert(const SurfacePoint& point, double tolerance, bool& snapped);

  /// The end of a half-edge within tolerance of the place at s in [0, 1] of its way, or kNone.
  Index near_end(Index corner, double s, double tolerance) const;
  /// The vertex at s of the way along the half-edge of a corner: an end within tolerance, else a new one, else, where
  /// a piece would have no area, the nearer end.
  Index split_edge(Index corner, double s, double tolerance);
  /// Tolerance of places on an edge: the smaller one of its two triangles.
  double edge_tolerance(Index corner, double share) const;

  /// Whether an edge lies on one of the input; these are split, never flipped.
  bool on_input_edge(Index corner) const;

  /// Makes the straight segment between two vertices of one input triangle a chain of constrained edges: edges in its
  /// way are flipped, constrained ones split (share: as in tolerance()). Appends the vertices after u, up to v. False where no input triangle
  /// holds both.   Ref: Sloan 1993, A fast algorithm for generating constrained Delaunay triangulations.
  bool connect(Index u, Index v, double share, std::vector<Index>& chain);

  /// Edges that stay when the triangulation is improved; their splits are remembered.
  void constrain(Index corner);
  bool is_constrained(Index corner) const { return constrained_[corner] != 0; }

  /// Appends the vertices after u, up to v, of an edge that was constrained and may have been split since.
  void follow(Index u, Index v, std::vector<Index>& chain) const;

  /// Flips edges inside input triangles until they are Delaunay in the plane of their triangle, constrained edges
  /// apart.   Ref: Lawson 1977; Chew 1989 (constrained Delaunay).
  void improve();

  SurfacePoint origin(Index new_vertex) const;
  std::vector<Vec3> take_position() { return std::move(position_); }
  std::vector<Index> take_corner_vertex() { return std::move(corner_vertex_); }
  std::vector<Index> take_triangle_origin() { return std::move(triangle_origin_); }

 private:
  /// Where a new vertex lies: on a half-edge of the input at `a` of its way, or inside a triangle.
  struct Site {
    Index half_edge = kNone;
    Index triangle = kNone;
    double a = 0, b = 0;  // inside: barycentric coordinates of corners 1 and 2
  };

  /// Barycentric coordinates of corners 1 and 2 of an input triangle that contains v.
  Vec2 local(Index v, Index input_triangle) const;
  RestFrame frame(Index input_triangle) const;
  Vec3 place(const Site& site) const;
  Index common_input_triangle(Index u, Index v) const;
  Index step_towards(Index from, Index to, Index input_triangle, double share, int detours);
  Index split_in_way(Index corner, Vec2 from, Vec2 to, Index input_triangle, double share);
  void clear_way(Index from, Index to, std::vector<Index> crossed, Index input_triangle);
  bool flip(Index corner);
  Index locate(Index input_triangle, Vec2 at) const;
  Index locate_by_search(Index input_triangle, Vec2 at) const;

  Index try_split_edge(Index corner, double s);
  Index try_split_triangle(Index t, Vec2 at);
  Index connect_on_edge(Index corner, const Site& site);
  bool site_on_input_edge(Index corner, double s, Site& site) const;
  bool site_inside(Index corner, double s, Site& site) const;
  Index add_vertex(const Site& site);
  Index add_triangle(Index a, Index b, Index c, Index origin);
  void join(Index corner, Index twin);
  /// Gives the outer side of half-edge `from` to half-edge `to`.
  void pass_on(Index from, Index to);
  bool wants_flip(Index corner) const;

  const Surface origin_;
  const Topology& topology_;
  std::vector<Vec3> position_;
  std::vector<Index> corner_vertex_, corner_twin_;
  std::vector<std::uint8_t> constrained_;  // of half-edges
  std::vector<Index> triangle_origin_;
  std::vector<Index> vertex_corner_;                 // one corner at each vertex
  std::vector<Site> site_;                           // of the new vertices
  std::unordered_map<std::uint64_t, Index> middle_;  // of constrained edges that were split
  std::vector<Index> changed_;                       // triangles made or cut, in order, with repeats
};

template <class Visit>
bool RefinedMesh::visit_star(Index v, Visit visit) const {
  const Index first = vertex_corner_[v];
  if (first == kNone) return false;
  Index c = first;
  do {
    if (visit(c)) return true;
    c = corner_twin_[previous_corner(c)];  // counter-clockwise
  } while (c != kNone && c != first);
  if (c == first) return false;
  for (c = corner_twin_[first]; c != kNone; c = corner_twin_[c]) {  // the rest of an open fan, clockwise
    c = next_corner(c);
    if (visit(c)) return true;
  }
  return false;
}

}  // namespace planish
