#include "io/polygons.hpp"

#include "kernels/topology/ear_clip.hpp"

namespace planish {
namespace {

/// Memory of one block's polygons, grown as needed.
struct Scratch {
  std::vector<Vec3> point;
  std::vector<Index> triangle, links;
};

void triangulate_one(Range corners, In<Index> corner_vertex, In<Vec3> position, Scratch& scratch,
                     Out<Index> triangle_corner) {
  const Index n = corners.end - corners.begin;
  if (n == 3) {
    for (Index i = 0; i < 3; ++i) triangle_corner[i] = corners.begin + i;
    return;
  }
  scratch.point.resize(n);
  scratch.links.resize(ear_clip_scratch(n));
  for (Index i = 0; i < n; ++i) scratch.point[i] = position[corner_vertex[corners.begin + i]];
  ear_clip(scratch.point, triangle_corner, scratch.links);
  for (Index& corner : triangle_corner) corner += corners.begin;
}

}  // namespace

std::string unusable_face(Offset num_corners) {
  if (num_corners < 3) return "a face has " + std::to_string(num_corners) + " corners, at least 3 are needed";
  if (num_corners <= kMostFaceCorners) return "";
  return "a face has " + std::to_string(num_corners) + " corners, at most " +
         std::to_string(kMostFaceCorners) + " are read";
}

std::vector<Index> triangulate(const Exec& exec, Offsets polygons, In<Index> corner_vertex,
                               In<Vec3> position) {
  std::vector<Index> triangle_corner(std::size_t{3} * num_triangles(polygons));
  exec.for_blocks(polygons.size(), kBlock, [&](Index, Range r) {
    Scratch scratch;
    for (Index p = r.begin; p < r.end; ++p) {
      const Offset first = Offset{3} * first_triangle(polygons, p);
      const Offset end = Offset{3} * first_triangle(polygons, p + 1);
      triangulate_one(polygons.group(p), corner_vertex, position, scratch,
                      Out<Index>(triangle_corner).subspan(first, end - first));
    }
  });
  return triangle_corner;
}

}  // namespace planish
