// What is said about an edited map.
#include <algorithm>

#include "engine/deform/editing.hpp"
#include "engine/flatten_steps.hpp"

namespace planish {

std::vector<Vec2> Editing::in_mesh_units(In<Vec2> uv) const {
  std::vector<Vec2> scaled(uv.begin(), uv.end());
  for (Vec2& z : scaled) z = mesh().unit * z;
  return scaled;
}

std::vector<Vec2> Editing::in_input_order(In<Vec2> uv) const {
  return planish::in_input_order(mesh(), in_mesh_units(uv));
}

DeformStep Editing::snapshot(int step) const {
  const std::vector<Vec2> map = in_mesh_units(uv_);
  return {step, planish::in_input_order(mesh(), map), measure_without_overlaps(exec_, piece_, map)};
}

DeformFacts Editing::facts(In<Vec2> map) const {
  DeformFacts facts{.reference = options_.reference,
                    .steps = last_.steps,
                    .way = way_,
                    .poses = last_.poses,
                    .map_scale = given_.scale,
                    .mirrored = given_.num_mirrored,
                    .release = release_};
  const std::vector<Vec2> given = in_mesh_units(aligned_);
  const Certificate before = measure_without_overlaps(exec_, piece_, given);
  facts.given_arap = before.arap;
  facts.given_flipped = before.flipped_triangles;
  double sum = 0;
  for (std::size_t v = 0; v < map.size(); ++v) {
    const double distance = norm(map[v] - given[v]);
    facts.largest_displacement = std::max(facts.largest_displacement, distance);
    sum += distance;
  }
  facts.mean_displacement = sum / static_cast<double>(map.size());
  return facts;
}

Deformation Editing::measure() {
  Deformation result;
  const std::vector<Vec2> map = in_mesh_units(uv_);
  (void)timed(Phase::Measure, {}, [&]() -> Result<void> {
    if (system_) {
      const DofMap dof(nodes_);
      const ConstraintSystem& system = release_ == Release::Map ? *anew_ : *system_;
      solved_.constraints = constraint_facts(system, dof, global_ ? global_->factor_nonzeros() : 0);
      solved_.constraints.outcome = system.outcomes(map);
    }
    solved_.certificate = measure_map(exec_, piece_, map);
    result.facts = facts(map);
    return {};
  });
  solved_.mesh = mesh_facts(piece_);
  solved_.mesh.outer = piece_.outer_loop;
  solved_.uv = planish::in_input_order(mesh(), map);
  result.flattening = solved_;
  return result;
}

}  // namespace planish
