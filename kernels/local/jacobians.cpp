#include "kernels/local/jacobians.hpp"

namespace planish {

void jacobians(Range r, In<RestFrame> frame, In<Vec2> uv, In<Index> corner_vertex, Out<Mat2> jacobian_of) {
  for (Index t = r.begin; t < r.end; ++t) {
    jacobian_of[t] = jacobian(frame[t], uv[corner_vertex[3 * t]], uv[corner_vertex[3 * t + 1]],
                              uv[corner_vertex[3 * t + 2]]);
  }
}

}  // namespace planish
