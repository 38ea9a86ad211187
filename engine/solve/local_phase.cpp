#include "engine/solve/local_phase.hpp"

#include <array>
#include <cstddef>

#include "kernels/local/proxy.hpp"

namespace planish {
namespace {

/// Triangles in a block: their corner forces, 96 kB, stay in the nearest caches, and a tenth of the vertices is shared.
constexpr Index kForceBlock = 2048;

std::vector<Index> held_vertices(In<std::uint8_t> fixed) {
  std::vector<Index> held;
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    if (fixed[v]) held.push_back(static_cast<Index>(v));
  }
  return held;
}

}  // namespace

LocalPhase::LocalPhase(const Exec& exec, const ArapEnergy& energy)
    : exec_(exec),
      energy_(energy),
      blocks_(star_blocks(exec, energy.corner_vertex, energy.stars, energy.star_corner, kForceBlock)),
      held_(held_vertices(energy.fixed)),
      kept_(blocks_.num_kept()) {}

template <class Triangles>
double LocalPhase::sweep(Triangles triangles, Out<Vec2> force) {
  const double energy = exec_.sum_blocks(energy_.num_triangles(), kForceBlock, [&](Range r) {
    alignas(64) std::array<std::byte, 3 * kForceBlock * sizeof(Vec2)>
        room;  // not set to zero as Vec2 would be
    const Out<Vec2> near(reinterpret_cast<Vec2*>(room.data()), 3 * kForceBlock);
    const double sum = triangles(r, near);
    const Index block = r.begin / kForceBlock, first_corner = 3 * r.begin;
    gather_runs(blocks_.runs_of(block), blocks_.inner, blocks_.slot, near, force);
    const Range outward = blocks_.outward_of(block);
    for (Index k = outward.begin; k < outward.end; ++k)
      kept_[blocks_.place[k]] = near[blocks_.outward[k] - first_corner];
    return sum;
  });
  exec_.for_blocks(static_cast<Index>(blocks_.shared.size()), kBlock, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) {
      Vec2 sum{};
      for (Index k = blocks_.kept_begin[i]; k < blocks_.kept_begin[i + 1]; ++k) sum += kept_[k];
      force[blocks_.shared[i]] = sum;
    }
  });
  for (const Index v : held_) force[v] = {};
  return energy;
}

double LocalPhase::evaluate(In<Vec2> uv, Out<Vec2> force) {
  return sweep(
      [&](Range r, Out<Vec2> near) {
        return local_phase(r, uv, energy_.corner_vertex, energy_.cotangent, energy_.frame, near);
      },
      force);
}

void LocalPhase::evaluate_rotations(In<Vec2> uv, In<Vec2> rotation, Out<Vec2> force) {
  sweep(
      [&](Range r, Out<Vec2> near) {
        rotation_forces(r, uv, rotation, energy_.corner_vertex, energy_.cotangent, energy_.frame, near);
        return 0.0;
      },
      force);
}

}  // namespace planish
