// Closest points on a surface.
#pragma once

#include <memory>

#include "engine/exec/parallel.hpp"
#include "engine/model/embedding.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// Closest points on a surface by Embree's bounding volume hierarchy. Embree prunes in float, with boxes and
/// radii that err outwards; the points themselves are computed in double, so an answer is the same as that of
/// a search through all triangles. It keeps the surface's views, not its arrays.
class SurfaceLocator {
 public:
  struct Hit {
    SurfacePoint at;              ///< coordinates exactly 0 on an edge, exactly 1 at a vertex
    Vec3 position;                ///< mesh units
    double distance = kInfinity;  ///< from the query, mesh units
  };

  /// What takes less time in all: a tree for few queries is built in two thirds of the time, and answers more slowly. Answers
  /// are the same.
  enum class Built { ForMany, ForFewQueries };

  /// Pre: indices in range, finite positions.   Throws std::bad_alloc as a container does.
  /// Cost: O(T log T), parallel; some 150 bytes a triangle.
  SurfaceLocator(const Exec& exec, const Surface& surface, Built built = Built::ForMany);
  ~SurfaceLocator();
  SurfaceLocator(SurfaceLocator&&) noexcept;
  SurfaceLocator& operator=(SurfaceLocator&&) noexcept;

  /// The nearest point at a distance <= radius; where there is none, or the query is not finite: triangle
  /// kNone. Of several triangles at the same distance the smallest. Thread safe.
  /// Cost: O(log T) near the surface; O(T) from farther away than 10^6 times the surface's size.
  Hit nearest(Vec3 query, double radius = kInfinity) const;

  /// The same among the triangles t with triangle_group[t] == group.   triangle_group [T]
  Hit nearest_in(In<Index> triangle_group, Index group, Vec3 query, double radius = kInfinity) const;

  /// hit[i] = nearest(query[i]), in parallel.
  void nearest(const Exec& exec, In<Vec3> query, Out<Hit> hit) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// The point of one triangle that is closest to the query. Right on needles too; points on a common edge have
/// the same distance, bit for bit, from both of its triangles.
/// Ref: regions as in Ericson, Real-Time Collision Detection, 2005, 5.1.5; the foot by Gram-Schmidt, twice,
/// because products of areas lose all their digits on needles.
SurfaceLocator::Hit closest_point(const Surface& surface, Index triangle, Vec3 query);

}  // namespace planish
