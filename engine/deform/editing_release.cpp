// Where triangles stay flipped, or parts of the map lie on one another, as long as features are held: features let go.
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

Faults Editing::faults(In<Vec2> uv) const {
  const Certificate c = last_.overlaps == Overlapping::Remove ? measure_map(exec_, piece_, uv)
                                                              : measure_without_overlaps(exec_, piece_, uv);
  return {c.flipped_triangles + c.overwound_vertices, c.overlapping_pairs};
}

bool Editing::is_as_asked(const Minimum& minimum) const {
  const OverlapRemoval& removal = minimum.overlaps;
  return minimum.injective && (removal.pairs_before == 0 || removal.start != OverlapRemoval::Start::None);
}

/// What has fewest faults of the map found so far and those that release more, until one is as it is to be.
Result<Minimum> Editing::let_go(Minimum best, const SolveOptions& options, const Monitor& monitor) {
  Faults least = faults(best.uv);
  for (const Release next : {Release::Features, Release::Map}) {
    const bool features = next == Release::Features;
    if (features && options.poses == FeaturePoses::Free) continue;
    auto minimum = features ? release(options, monitor, mending()) : start_anew(options, monitor);
    if (!minimum && !features && minimum.error().code == ErrorCode::ConstraintsConflict) return best;
    if (!minimum) return minimum;
    const Faults left = faults(minimum->uv);
    const bool done = is_as_asked(*minimum);
    if (!done && !(left < least)) continue;
    least = left;
    best = std::move(*minimum);
    release_ = next;
    if (done) break;
  }
  return best;
}

/// Features as unknowns, from where they were placed and the rotations of the map.
Result<Minimum> Editing::release(const SolveOptions& options, const Monitor& monitor, Mending mending) {
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
  arap.untangles_first_map = false;
  arap.turns_freely = turning_components(*system_, piece_.component);
  const FlattenOptions chosen = flatten_options(options);
  auto minimum = lower(arap, chosen, monitor, mending, released_starts(arap, chosen, monitor));
  if (!minimum) return minimum;
  if (auto scales = system_->check_scales(final_poses(*minimum, *dof)); !scales) return fail(scales.error());
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
  auto minimum = lower(arap, chosen, monitor, mending(), anew_starts(arap, chosen, monitor));
  if (!minimum) return minimum;
  if (auto scales = anew_->check_scales(final_poses(*minimum, start->last())); !scales)
    return fail(scales.error());
  if (minimum->overlaps.start == OverlapRemoval::Start::Unconstrained) anew_ = std::move(near_system_);
  move_back(*anew_, minimum->uv);
  return minimum;
}

/// Features that were pulled into place lie as another DOF map has them.
const Poses& Editing::final_poses(const Minimum& minimum, const DofMap& dof) const {
  const bool pulled = minimum.overlaps.start == OverlapRemoval::Start::Unconstrained;
  return pulled ? *separated_dof_->poses() : *dof.poses();
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
