#include "kernels/local/proxy.hpp"

namespace planish {

double local_phase(Range r, In<Vec2> uv, In<Index> corner_vertex, In<double> cotangent, In<RestFrame> frame,
                   Out<Vec2> force) {
  double energy = 0;
  for (Index t = r.begin; t < r.end; ++t) {
    const std::array<Vec2, 3> z = {uv[corner_vertex[3 * t]], uv[corner_vertex[3 * t + 1]],
                                   uv[corner_vertex[3 * t + 2]]};
    const double* cot = &cotangent[3 * t];
    const ProxyForces f = proxy_forces(z, cot, frame[t], closest_rotation(z, cot, frame[t]));
    energy += f.energy;
    for (int i = 0; i < 3; ++i) force[3 * t + i] = f.force[i];
  }
  return energy;
}

void rotation_forces(Range r, In<Vec2> rotation, In<double> cotangent, In<RestFrame> frame, Out<Vec2> force) {
  for (Index t = r.begin; t < r.end; ++t) {
    const ProxyForces f = proxy_forces({}, &cotangent[3 * t], frame[t], rotation[t]);
    for (int i = 0; i < 3; ++i) force[3 * t + i] = f.force[i];
  }
}

void gather_forces(Range r, In<Index> star_begin, In<Index> star_corner, In<Vec2> force,
                   Out<Vec2> vertex_force) {
  for (Index v = r.begin; v < r.end; ++v) {
    Vec2 sum{};
    for (Index k = star_begin[v]; k < star_begin[v + 1]; ++k) sum += force[star_corner[k]];
    vertex_force[v] = sum;
  }
}

}  // namespace planish
