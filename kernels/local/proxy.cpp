#include "kernels/local/proxy.hpp"

#include <algorithm>
#include <tuple>

#include "kernels/base/lanes.hpp"

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

namespace {

/// Complex numbers of four triangles.
struct LaneVec2 {
  Lanes x, y;
};
PLANISH_INLINE LaneVec2 operator-(const LaneVec2& a, const LaneVec2& b) { return {a.x - b.x, a.y - b.y}; }
PLANISH_INLINE LaneVec2 operator*(const Lanes& s, const LaneVec2& a) { return {s * a.x, s * a.y}; }
PLANISH_INLINE Lanes dot(const LaneVec2& a, const LaneVec2& b) { return a.x * b.x + a.y * b.y; }

PLANISH_INLINE Lanes square_root(Lanes a) {
  for (Index k = 0; k < kLanes; ++k) a[k] = std::sqrt(a[k]);
  return a;
}

PLANISH_INLINE const Lanes& lanes(const double* p) { return *reinterpret_cast<const Lanes*>(p); }

/// First, second and third of four triples that stand one behind the other.
struct LaneTriple {
  Lanes first, second, third;
};
PLANISH_INLINE LaneTriple triples(const double* p) {
  const Lanes a = lanes(p), b = lanes(p + 4), c = lanes(p + 8);
  const Lanes outer = __builtin_shufflevector(a, b, 0, 1, 6, 7),
              middle = __builtin_shufflevector(a, c, 2, 3, 4, 5),
              inner = __builtin_shufflevector(b, c, 0, 1, 6, 7);
  return {__builtin_shufflevector(outer, middle, 0, 5, 2, 7),
          __builtin_shufflevector(outer, inner, 1, 4, 3, 6),
          __builtin_shufflevector(middle, inner, 0, 5, 2, 7)};
}

using Pair __attribute__((vector_size(16), aligned(8), may_alias)) = double;

PLANISH_INLINE Lanes two_points(const Vec2& a, const Vec2& b) {
  return __builtin_shufflevector(reinterpret_cast<const Pair&>(a), reinterpret_cast<const Pair&>(b), 0, 1, 2,
                                 3);
}

PLANISH_INLINE LaneVec2 images(const Vec2* uv, const Index* corner_vertex) {
  const Lanes even = two_points(uv[corner_vertex[0]], uv[corner_vertex[6]]),
              odd = two_points(uv[corner_vertex[3]], uv[corner_vertex[9]]);
  return {__builtin_shufflevector(even, odd, 0, 4, 2, 6), __builtin_shufflevector(even, odd, 1, 5, 3, 7)};
}

/// Forces of one corner of four triangles.
PLANISH_INLINE void store(const LaneVec2& f, Vec2* force) {
  const Lanes even = __builtin_shufflevector(f.x, f.y, 0, 4, 2, 6),
              odd = __builtin_shufflevector(f.x, f.y, 1, 5, 3, 7);
  const auto to = [&](Index k) -> Pair& { return reinterpret_cast<Pair&>(force[3 * k]); };
  to(0) = __builtin_shufflevector(even, even, 0, 1);
  to(1) = __builtin_shufflevector(odd, odd, 0, 1);
  to(2) = __builtin_shufflevector(even, even, 2, 3);
  to(3) = __builtin_shufflevector(odd, odd, 2, 3);
}

/// closest_rotation and proxy_forces of four triangles at once; returns their energies.
PLANISH_INLINE Lanes local_phase_of_four(const Vec2* uv, const Index* corner_vertex, const double* cotangent,
                                         const RestFrame* frame, Vec2* force) {
  const LaneVec2 z0 = images(uv, corner_vertex), z1 = images(uv, corner_vertex + 1),
                 z2 = images(uv, corner_vertex + 2);
  const auto [w1, w2, w0] = triples(cotangent);  // each edge has the cotangent of the corner opposite
  const auto [x1, x2, y2] = triples(&frame->x1);
  const Lanes x12 = x2 - x1;
  // Half-edge vectors of the image; those of the frame are (x1, 0), (x12, y2), (-x2, -y2).
  const LaneVec2 e0 = z1 - z0, e1 = z2 - z1, e2 = z0 - z2;
  const LaneVec2 s = {w0 * (e0.x * x1) + w1 * (e1.x * x12 + e1.y * y2) - w2 * (e2.x * x2 + e2.y * y2),
                      w0 * (e0.y * x1) + w1 * (e1.y * x12 - e1.x * y2) - w2 * (e2.y * x2 - e2.x * y2)};
  const Lanes squared = dot(s, s), one = Lanes{} + 1.0;
  const auto turned = squared > 0;
  const Lanes inverse = one / square_root(turned ? squared : one);
  const LaneVec2 r = {turned ? inverse * s.x : one, turned ? inverse * s.y : Lanes{}};
  const LaneVec2 d0 = e0 - x1 * r, d1 = e1 - LaneVec2{r.x * x12 - r.y * y2, r.x * y2 + r.y * x12},
                 d2 = {e2.x + (r.x * x2 - r.y * y2), e2.y + (r.x * y2 + r.y * x2)};
  const LaneVec2 f0 = (0.5 * w0) * d0, f1 = (0.5 * w1) * d1, f2 = (0.5 * w2) * d2;
  store(f2 - f0, force);
  store(f0 - f1, force + 1);
  store(f1 - f2, force + 2);
  return dot(f0, d0) + dot(f1, d1) + dot(f2, d2);
}

/// Asks for what later triangles read, as far ahead as measured best: the processor foresees neither the points, which are far
/// from one another, nor enough of the arrays.
PLANISH_INLINE void prefetch_ahead(Index t, In<Vec2> uv, In<Index> corner_vertex, In<double> cotangent,
                                   In<RestFrame> frame) {
  constexpr Index kArraysAhead = 96, kPointsAhead = 32, kLine = 64 / sizeof(double);  // triangles
  const auto last = static_cast<Index>(frame.size()) - 1;
  const Index later = std::min(t + kArraysAhead, last), soon = std::min(t + kPointsAhead, last - kLanes + 1);
  for (const double* p : {&frame[later].x1, &cotangent[3 * later]}) {
    __builtin_prefetch(p);
    __builtin_prefetch(p + kLine);
  }
  __builtin_prefetch(&corner_vertex[3 * later]);
  for (Index k = soon; k < soon + kLanes; ++k) {
    // The first corner is near those of the triangle before.
    __builtin_prefetch(&uv[corner_vertex[3 * k + 1]]);
    __builtin_prefetch(&uv[corner_vertex[3 * k + 2]]);
  }
}

}  // namespace

PLANISH_CLONES double local_phase(Range r, In<Vec2> uv, In<Index> corner_vertex, In<double> cotangent,
                                  In<RestFrame> frame, Out<Vec2> force) {
  static_assert(sizeof(RestFrame) == 3 * sizeof(double));
  Lanes energies{};
  Index t = r.begin;
  for (; t + kLanes <= r.end; t += kLanes) {
    prefetch_ahead(t, uv, corner_vertex, cotangent, frame);
    energies += local_phase_of_four(uv.data(), &corner_vertex[3 * t], &cotangent[3 * t], &frame[t],
                                    &force[3 * (t - r.begin)]);
  }
  double energy = (energies[0] + energies[1]) + (energies[2] + energies[3]);
  for (; t < r.end; ++t) {
    const std::array<Vec2, 3> z = {uv[corner_vertex[3 * t]], uv[corner_vertex[3 * t + 1]],
                                   uv[corner_vertex[3 * t + 2]]};
    const double* cot = &cotangent[3 * t];
    const ProxyForces f = proxy_forces(z, cot, frame[t], closest_rotation(z, cot, frame[t]));
    energy += f.energy;
    for (int i = 0; i < 3; ++i) force[3 * (t - r.begin) + i] = f.force[i];
  }
  return energy;
}

void rotation_forces(Range r, In<Vec2> uv, In<Vec2> rotation, In<Index> corner_vertex, In<double> cotangent,
                     In<RestFrame> frame, Out<Vec2> force) {
  for (Index t = r.begin; t < r.end; ++t) {
    const std::array<Vec2, 3> z = {uv[corner_vertex[3 * t]], uv[corner_vertex[3 * t + 1]],
                                   uv[corner_vertex[3 * t + 2]]};
    const ProxyForces f = proxy_forces(z, &cotangent[3 * t], frame[t], rotation[t]);
    for (int i = 0; i < 3; ++i) force[3 * (t - r.begin) + i] = f.force[i];
  }
}

}  // namespace planish
