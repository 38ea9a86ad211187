#include "kernels/local/proxy.hpp"

#include <algorithm>
#include <tuple>

namespace planish {

std::array<std::array<Mat2, 3>, 3> proxy_hessian(const std::array<Vec2, 3>& z, const double* cotangent,
                                                 const RestFrame& frame, Convexity convexity) {
  const auto x = edge_vectors(frame);
  std::array<std::array<Mat2, 3>, 3> hessian{};
  std::array<Vec2, 3> q{};  // s = sum of z_i conj(q_i)
  double rest = 0;          // |s| of an isometric image
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const double weight = cotangent[(k + 2) % 3], half = 0.5 * weight;
    q[next] += weight * x[k];
    q[k] += -weight * x[k];
    rest += weight * dot(x[k], x[k]);
    for (const auto& [i, j, value] :
         {std::tuple{k, k, half}, {next, next, half}, {k, next, -half}, {next, k, -half}}) {
      hessian[i][j].m00 += value;
      hessian[i][j].m11 += value;
    }
  }
  Vec2 s{};
  for (int i = 0; i < 3; ++i) s += multiply(z[i], conjugate(q[i]));
  const double length = norm(s);
  const Vec2 direction = length > 0 ? (1 / length) * s : Vec2{1, 0};
  const bool as_it_is = convexity == Convexity::True && length > 0;
  const double scale = 0.5 / (as_it_is ? length : std::max(length, rest));
  std::array<Vec2, 3> across;
  for (int i = 0; i < 3; ++i) across[i] = multiply({0, 1}, multiply(direction, q[i]));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Mat2& block = hessian[i][j];
      block.m00 -= scale * across[i].x * across[j].x;
      block.m01 -= scale * across[i].x * across[j].y;
      block.m10 -= scale * across[i].y * across[j].x;
      block.m11 -= scale * across[i].y * across[j].y;
    }
  }
  return hessian;
}

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
