// The local phase: closest rotation of each triangle, its energy, and the forces it puts on its corners.
#pragma once

#include <array>

#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// One triangle against a rotation: energy A |J - R|^2 and half its gradient with respect to the corners.
struct ProxyForces {
  double energy = 0;
  std::array<Vec2, 3> force;
};

/// Closest rotation in the weights' metric, as a unit complex number; 1 where every rotation is equally
/// close.
///   z: images of the corners;  cotangent [3] at the corners;  frame: reference frame.
///   Ref: Liu et al. 2008, eq. 5; in complex numbers sum of cot dz conj(dx), normalised.
inline Vec2 closest_rotation(const std::array<Vec2, 3>& z, const double* cotangent, const RestFrame& frame) {
  const auto x = edge_vectors(frame);
  const Vec2 s = cotangent[2] * multiply(z[1] - z[0], conjugate(x[0])) +
                 cotangent[0] * multiply(z[2] - z[1], conjugate(x[1])) +
                 cotangent[1] * multiply(z[0] - z[2], conjugate(x[2]));
  const double squared = dot(s, s);
  return squared > 0 ? (1 / std::sqrt(squared)) * s : Vec2{1, 0};
}

/// Energy 1/2 sum of cot |dz - R dx|^2 = A |J - R|_F^2 and the forces L z - b of the triangle.
inline ProxyForces proxy_forces(const std::array<Vec2, 3>& z, const double* cotangent, const RestFrame& frame,
                                Vec2 rotation) {
  const auto x = edge_vectors(frame);
  const Vec2 d0 = z[1] - z[0] - multiply(rotation, x[0]);
  const Vec2 d1 = z[2] - z[1] - multiply(rotation, x[1]);
  const Vec2 d2 = z[0] - z[2] - multiply(rotation, x[2]);
  // Each edge pulls with half the cotangent of the corner opposite.
  const Vec2 f0 = 0.5 * cotangent[2] * d0, f1 = 0.5 * cotangent[0] * d1, f2 = 0.5 * cotangent[1] * d2;
  return {dot(f0, d0) + dot(f1, d1) + dot(f2, d2), {f2 - f0, f0 - f1, f1 - f2}};
}

/// Half the Hessian of the triangle's energy with respect to its corners, as blocks [3][3] of 2x2.
enum class Convexity {
  True,       ///< the second derivative as it is; indefinite where the triangle is compressed
  Projected,  ///< its positive semidefinite part: the rotation's term bounded by that of an isometric image
};

/// With E = 1/2 sum cot |dz|^2 - |s| + constant and s = sum cot dz conj(dx), the Hessian is the Laplacian's
/// minus k k^T / |s|, k the derivative of s across its own direction; s = 0 is treated as Projected.
///   Ref: closed form of the 2x2 ARAP Hessian, Smith, De Goes and Kim 2019, in complex numbers.
std::array<std::array<Mat2, 3>, 3> proxy_hessian(const std::array<Vec2, 3>& z, const double* cotangent,
                                                 const RestFrame& frame, Convexity convexity);

/// Local phase of triangles r: forces of every corner for its closest rotation; returns the energy of r.
///   uv [V];  corner_vertex [3 T];  cotangent [3 T];  frame [T]
///   force [3 |r|] out: those of the corners of r alone, half the energy's gradient.
double local_phase(Range r, In<Vec2> uv, In<Index> corner_vertex, In<double> cotangent, In<RestFrame> frame,
                   Out<Vec2> force);

/// The same against given rotations [T].
void rotation_forces(Range r, In<Vec2> uv, In<Vec2> rotation, In<Index> corner_vertex, In<double> cotangent,
                     In<RestFrame> frame, Out<Vec2> force);

}  // namespace planish
