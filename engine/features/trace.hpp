// Paths over a surface from vertex to vertex: where they cross edges. Nothing is changed.
#pragma once

#include <optional>
#include <vector>

#include "engine/features/refined_mesh.hpp"

namespace planish {

/// One place of a path: on the edge from `tail` to `head` at s of its way, or at the vertex `tail` (head kNone).
struct Crossing {
  Index tail = kNone, head = kNone;
  double s = 0;
};

/// The places between two vertices, in order; consecutive ones lie in a common triangle.
using SurfacePath = std::vector<Crossing>;

/// The straight segment that a path stands for, and how far the path may be from it.
struct Chord {
  Vec3 from, to;
  double allowed = 0;  ///< mesh units, > 0
};

double distance_to(const Chord& chord, Vec3 point);

/// Follows the plane through the segment that contains `normal`, from triangle to triangle. The side of a vertex is
/// computed the same way each time, so that neighbouring triangles agree.
/// None where the plane leads off the surface, or away from the segment.   Cost: O(triangles crossed).
std::optional<SurfacePath> path_in_plane(const RefinedMesh& mesh, Index from, Index to, Vec3 normal,
                                         const Chord& chord);

/// The shortest path within a strip of triangles near the segment; goes round notches and along boundaries.
/// None where no strip near the segment joins the two.   Cost: O(k log k) for k triangles near the segment.
/// Ref: Lee and Preparata 1984 (funnel).
std::optional<SurfacePath> path_in_strip(const RefinedMesh& mesh, Index from, Index to, const Chord& chord);

}  // namespace planish
