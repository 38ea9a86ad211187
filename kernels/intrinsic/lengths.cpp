#include "kernels/intrinsic/lengths.hpp"

namespace planish {

void rest_frames(Range triangles, In<Vec3> position, In<Index> corner_vertex, Out<RestFrame> frame) {
  for (Index t = triangles.begin; t < triangles.end; ++t) {
    frame[t] = rest_frame(position[corner_vertex[3 * t]], position[corner_vertex[3 * t + 1]],
                          position[corner_vertex[3 * t + 2]]);
  }
}

void corner_angles(Range triangles, In<RestFrame> frame, Out<double> angle) {
  for (Index t = triangles.begin; t < triangles.end; ++t) {
    const auto a = corner_angles(frame[t]);
    for (int i = 0; i < 3; ++i) angle[3 * t + i] = a[i];
  }
}

}  // namespace planish
