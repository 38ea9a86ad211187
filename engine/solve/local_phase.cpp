#include "engine/solve/local_phase.hpp"

#include "kernels/local/proxy.hpp"

namespace planish {

LocalPhase::LocalPhase(const Exec& exec, const ArapEnergy& energy)
    : exec_(exec), energy_(energy), corner_force_(energy.corner_vertex.size()) {}

void LocalPhase::gather(Out<Vec2> force) const {
  exec_.for_blocks(energy_.num_vertices(), kBlock, [&](Index, Range r) {
    gather_forces(r, energy_.stars.begin, energy_.star_corner, corner_force_, force);
    for (Index v = r.begin; v < r.end; ++v) {
      if (energy_.fixed[v]) force[v] = {};
    }
  });
}

double LocalPhase::evaluate(In<Vec2> uv, Out<Vec2> force) {
  const double energy = exec_.sum_blocks(energy_.num_triangles(), kBlock, [&](Range r) {
    return local_phase(r, uv, energy_.corner_vertex, energy_.cotangent, energy_.frame, corner_force_);
  });
  gather(force);
  return energy;
}

void LocalPhase::evaluate_rotations(In<Vec2> uv, In<Vec2> rotation, Out<Vec2> force) {
  exec_.for_blocks(energy_.num_triangles(), kBlock, [&](Index, Range r) {
    rotation_forces(r, uv, rotation, energy_.corner_vertex, energy_.cotangent, energy_.frame, corner_force_);
  });
  gather(force);
}

}  // namespace planish
