#include "engine/solve/map_energy.hpp"

#include <algorithm>

#include "kernels/exact/orient2.hpp"
#include "kernels/local/star_sums.hpp"

namespace planish {

ProxyForces triangle_forces(const MapDensity& density, const RestFrame& frame, const std::array<Vec2, 3>& z) {
  const CornerWeights a = corner_weights(frame);
  const Wirtinger j = wirtinger(a, z);
  const IsotropicTerms terms = density(j);
  const double rest = area(frame);
  ProxyForces result{rest * terms.value, corner_gradient(a, j, terms)};
  for (Vec2& f : result.force) f = 0.5 * rest * f;
  return result;
}

std::array<std::array<Mat2, 3>, 3> triangle_hessian(const MapDensity& density, double projection,
                                                    double multiple, const RestFrame& frame,
                                                    const std::array<Vec2, 3>& z) {
  const CornerWeights a = corner_weights(frame);
  const Wirtinger j = wirtinger(a, z);
  const IsotropicTerms exact = density(j), nearest = projected(plus_determinant(exact, j, multiple));
  const double half = 0.5 * area(frame);
  const auto mix = [&](double from, double to) { return half * (from + projection * (to - from)); };
  return corner_hessian(a, j,
                        {.across_p = mix(exact.across_p, nearest.across_p),
                         .across_q = mix(exact.across_q, nearest.across_q),
                         .pp = mix(exact.pp, nearest.pp),
                         .pq = mix(exact.pq, nearest.pq),
                         .qq = mix(exact.qq, nearest.qq)});
}

EdgeTerms edge_terms(const MapDensity& density, double x) {
  if (density.kind == MapDensity::Kind::Untangling) {
    const double root = std::hypot(density.epsilon, x), k = 1 / untangling_chi(x, density.epsilon);
    const double k1 = -k / root, k2 = k / (root * root) * (1 + x / root);
    return {(x * x + 1) * k, 2 * x * k + (x * x + 1) * k1, 2 * k + 4 * x * k1 + (x * x + 1) * k2};
  }
  const auto [weight, delta] = density.barrier;
  const double y = x / delta;
  if (y >= 1) return {};
  if (y <= 0) return {.value = kInfinity};
  return {weight * (1 - y) * (1 - y) * (1 - y) / y, weight / delta * (3 - 2 * y - 1 / (y * y)),
          weight / (delta * delta) * (2 / (y * y * y) - 2)};
}

MapEnergy::MapEnergy(const Exec& exec, const ArapEnergy& mesh) : exec_(exec), mesh_(mesh) {}

double MapEnergy::evaluate(const MapDensity& density, In<Vec2> uv, Out<Vec2> force) {
  corner_force_.resize(mesh_.corner_vertex.size());
  const double energy = exec_.sum_blocks(mesh_.num_triangles(), kBlock, [&](Range r) {
    double sum = 0;
    for (Index t = r.begin; t < r.end; ++t) {
      const ProxyForces f =
          triangle_forces(density, mesh_.frame[t], corner_images(mesh_.corner_vertex, t, uv));
      sum += f.energy;
      std::copy(f.force.begin(), f.force.end(), &corner_force_[3 * static_cast<std::size_t>(t)]);
    }
    return sum;
  });
  exec_.for_blocks(mesh_.num_vertices(), kBlock, [&](Index, Range r) {
    gather_forces(r, mesh_.stars.begin, mesh_.star_corner, corner_force_, force);
    for (Index v = r.begin; v < r.end; ++v) {
      if (mesh_.fixed[v]) force[v] = {};
    }
  });
  return energy;
}

template <class Value>
double MapEnergy::least(Value value) const {
  std::vector<double> part(Exec::num_blocks(mesh_.num_triangles(), kBlock), kInfinity);
  exec_.for_blocks(mesh_.num_triangles(), kBlock, [&](Index block, Range r) {
    for (Index t = r.begin; t < r.end; ++t) part[block] = std::min(part[block], value(t));
  });
  return *std::min_element(part.begin(), part.end());
}

double MapEnergy::first_flip(In<Vec2> uv, In<Vec2> direction) const {
  return least([&](Index t) {
    return planish::first_flip(corner_images(mesh_.corner_vertex, t, uv),
                               corner_images(mesh_.corner_vertex, t, direction));
  });
}

double MapEnergy::least_determinant(In<Vec2> uv) const {
  return least([&](Index t) {
    const auto z = corner_images(mesh_.corner_vertex, t, uv);
    return 0.5 * cross(z[1] - z[0], z[2] - z[0]) / area(mesh_.frame[t]);
  });
}

std::vector<Index> MapEnergy::flipped(In<Vec2> uv) const {
  return select(exec_, mesh_.num_triangles(), [&](Index t) {
    const auto z = corner_images(mesh_.corner_vertex, t, uv);
    return orient2(z[0], z[1], z[2]) <= 0;
  });
}

bool MapEnergy::is_injective(In<Vec2> uv) const {
  if (!flipped(uv).empty()) return false;
  if (!winding_) winding_.emplace(exec_, mesh_);
  return winding_->is_single(uv);
}

}  // namespace planish
