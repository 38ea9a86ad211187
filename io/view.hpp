// From where a surface in space is looked at, so that most of it is seen.
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// Orthonormal directions of a parallel projection, right-handed.
struct View {
  Vec3 right{1, 0, 0}, up{0, 1, 0};
  Vec3 toward{0, 0, 1};  ///< from the surface to the viewer

  /// x to the right, y up, z towards the viewer; mesh units.
  Vec3 project(Vec3 p) const { return {dot(p, right), dot(p, up), dot(p, toward)}; }
};

/// Along the mean normal; where normals cancel (closed surfaces) along the direction of least extent. The
/// longest direction lies across the picture, and up is rather along a coordinate axis than against it.
/// Same bits for any number of threads.   Pre: indices in range, finite.   Cost: O(T).
View choose_view(const Exec& exec, const Surface& surface);

}  // namespace planish
