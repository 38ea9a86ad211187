// Where triangles stay flipped as long as features are held: features let go, as flatten has them.
#include "engine/constraints/constrained_start.hpp"
#include "engine/deform/editing.hpp"
#include "engine/flatten_steps.hpp"

namespace planish {
namespace {

/// Components that nothing says how to turn once features turn with them.
std::vector<std::uint8_t> turning_components(const ConstraintSystem& system, In<Index> vertex_component) {
  std::vector<std::uint8_t> turns;
  for (const std::uint8_t directed : system.directed()) turns.push_back(!directed);
  std::vector<Index> pins(turns.size(), 0);
  for (const Pin& pin : system.pins()) {
    if (++pins[vertex_component[pin.vertex]] > 1) turns[vertex_component[pin.vertex]] = 0;
  }
  return turns;
}

}  // namespace

Offset Editing::faults(In<Vec2> uv) const {
  const Certificate c = measure_without_overlaps(exec_, piece_, uv);
  return c.flipped_triangles + c.overwound_vertices;
}

/// From the start that leaves fewer faults; the map as it was held where neither helps.
Result<Minimum> Editing::let_go(Minimum held, const SolveOptions& options, const Monitor& monitor) {
  auto released = release(options, monitor);
  if (!released) return released;
  if (released->injective) {
    release_ = Release::Features;
    return released;
  }
  const Offset left_held = faults(held.uv), left = faults(released->uv);
  auto anew = start_anew(options, monitor);
  if (!anew && anew.error().code != ErrorCode::ConstraintsConflict) return anew;
  if (anew && faults(anew->uv) < std::min(left_held, left)) {
    release_ = Release::Map;
    return anew;
  }
  if (left >= left_held) return held;
  release_ = Release::Features;
  return released;
}

/// Features as unknowns, from where they were placed and the rotations of the map.
Result<Minimum> Editing::release(const SolveOptions& options, const Monitor& monitor) {
  auto poses = system_->poses_at(aligned_), same = system_->poses_at(aligned_);
  if (!poses || !same) return fail(poses ? same.error() : poses.error());
  const auto dof = system_->dof_map(std::move(*poses), false),
             still = system_->dof_map(std::move(*same), true);
  if (auto few = check_border(*dof); !few) return fail(few.error());
  auto global = GlobalPhase::factor(exec_, laplacian_over(system_->nodes()), piece_.order);
  if (!global) return fail(global.error());
  const std::vector<Vec2> rotation = closest_rotations();
  ArapProblem arap = problem(*global, system_->nodes(), *dof, rotation);
  arap.first = still.get();
  arap.turns_freely = turning_components(*system_, piece_.component);
  auto minimum = lower(arap, flatten_options(options), monitor, true);
  if (!minimum) return minimum;
  if (auto scales = system_->check_scales(*dof->poses()); !scales) return fail(scales.error());
  move_back(*system_, minimum->uv);
  return minimum;
}

/// As flatten begins, with the rotations of the smallest connection, by a constraint system oriented there.
Result<Minimum> Editing::start_anew(const SolveOptions& options, const Monitor& monitor) {
  const FlattenOptions chosen = flatten_options(options);
  auto made = compiled_system(monitor);
  if (!made) return fail(made.error());
  anew_ = std::move(*made);
  if (auto oriented = anew_->orient(exec_, piece_.start_input(), chosen.init); !oriented)
    return fail(oriented.error());
  auto global = GlobalPhase::factor(exec_, laplacian_over(anew_->nodes()), piece_.order);
  if (!global) return fail(global.error());
  auto start = constrained_start(exec_, piece_, *anew_, *global, chosen, monitor);
  if (!start) return fail(start.error());
  ArapProblem arap = problem(*global, anew_->nodes(), start->last(), start->rotation);
  arap.first = start->first.get();
  arap.turns_freely = turning_components(*anew_, piece_.component);
  auto minimum = lower(arap, chosen, monitor, true);
  if (!minimum) return minimum;
  if (auto scales = anew_->check_scales(*start->last().poses()); !scales) return fail(scales.error());
  move_back(*anew_, minimum->uv);
  return minimum;
}

/// The DOF map of released features has something of each component without pins at 0.
void Editing::move_back(const ConstraintSystem& system, Out<Vec2> uv) const {
  std::vector<Freedom> freedom;
  for (const std::uint8_t directed : system.directed())
    freedom.push_back(directed ? Freedom::Shift : Freedom::Isometry);
  for (const Pin& pin : system.pins()) freedom[piece_.component[pin.vertex]] = Freedom::None;
  move_components(onto_map(freedom, piece_.component, uv, aligned_), piece_.component, uv);
}

}  // namespace planish
