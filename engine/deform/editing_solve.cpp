// Solving an edited map: constrained elements held, the rest as rigid as possible, flips removed.
#include <algorithm>

#include "engine/deform/editing.hpp"
#include "engine/flatten_steps.hpp"
#include "engine/solve/flip_free.hpp"
#include "engine/solve/map_energy.hpp"
#include "engine/verify/certificate.hpp"
#include "kernels/local/proxy.hpp"

namespace planish {
namespace {

/// A step on the way need not be exact: the next one begins there.
constexpr double kWayTolerance = 1e-3;
constexpr int kWayIterations = 20;

/// With features held untangling succeeds within some ten steps, or, where they leave no room between them, not at all.
constexpr int kHeldUntanglingSteps = 30;

}  // namespace

FlattenOptions Editing::flatten_options(const SolveOptions& options) const {
  FlattenOptions result;
  result.energy = options.energy;
  result.flips = options.flips;
  result.overlaps = options.overlaps;
  result.tolerance = options.tolerance;
  result.max_iterations = options.max_iterations;
  result.threads = options_.threads;
  return result;
}

Result<void> Editing::solve(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  std::vector<Vec2> before = pool_.copy(uv_);
  auto solved = go_on(options, monitor, sink);
  if (!solved) {
    uv_.swap(before);
    settled_ = false;
  }
  pool_.give(std::move(before));
  return solved;
}

Result<void> Editing::go_on(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  last_ = options;
  way_.clear();
  if (auto factored = timed(Phase::Start, monitor, [&] { return factor(); }); !factored) return factored;
  std::vector<Vec2> start = pool_.copy(uv_);
  if (auto taken = say_step(0, sink); !taken) return taken;
  release_ = Release::None;
  settled_ = settled_ && options.steps == 1;
  auto minimum = follow(options, monitor, sink);
  if (minimum && options.flips == Flips::Untangle && !is_as_asked(*minimum) && has_features()) {
    uv_ = start;
    settled_ = false;
    minimum = let_go(std::move(*minimum), options, monitor);
  }
  pool_.give(std::move(start));
  if (!minimum) return fail(minimum.error());
  settled_ = minimum->injective && release_ == Release::None && options.poses == FeaturePoses::Held;
  keep(std::move(*minimum));
  settle_gauge();
  return say_step(options.steps, sink);
}

/// The map as it is now, to whom it concerns.
Result<void> Editing::say_step(int step, const StepSink& sink) {
  if (!sink && last_.steps == 1) return {};
  DeformStep now = snapshot(step);
  const Certificate& c = now.certificate;
  if (last_.steps > 1)
    way_.push_back(
        {.step = step, .arap = c.arap, .flipped = c.flipped_triangles, .overwound = c.overwound_vertices});
  return sink ? sink(std::move(now)) : Result<void>();
}

/// From where the map is, step by step, all but the last one told. Steps begin without flips where those before them had
/// none, and end so where that is possible with the features held.
Result<Minimum> Editing::follow(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  std::optional<FeatureMotion> motion;
  if (system_) motion.emplace(*system_, *placed_, uv_);
  bool mends = options.steps > 1 && options.flips == Flips::Untangle && faults(uv_).turned == 0;
  for (int step = 1;; ++step) {
    nodes_.place.clear();
    if (motion) nodes_.place = motion->at(static_cast<double>(step) / options.steps);
    for (const Index v : alone_) nodes_.place.emplace_back(v, uv_[v]);
    if (step == options.steps) return last_step(options, monitor);
    auto minimum = step_on_the_way(options, monitor, mends);
    if (!minimum) return minimum;
    uv_ = std::move(minimum->uv);
    mends = mends && minimum->injective;
    if (auto taken = say_step(step, sink); !taken) return fail(taken.error());
  }
}

Result<Minimum> Editing::last_step(const SolveOptions& options, const Monitor& monitor) {
  if (options.poses == FeaturePoses::Free && has_features())
    return release(options, monitor, mending() == Mending::None ? Mending::None : Mending::AtEnd);
  if (settled_ && options.flips == Flips::Untangle) return follow_held(options, monitor);
  responses_.forget();  // they go from one minimum to the next
  return minimise(flatten_options(options), monitor, mending());
}

Result<Minimum> Editing::step_on_the_way(const SolveOptions& options, const Monitor& monitor, bool mending) {
  FlattenOptions loose = flatten_options(options);
  loose.tolerance = std::max(loose.tolerance, kWayTolerance);
  loose.max_iterations = std::min(loose.max_iterations, kWayIterations);
  loose.overlaps = Overlapping::Report;
  return minimise(loose, monitor, mending ? Mending::AtEnd : Mending::None);
}

/// With what is held where it is to be.
Result<Minimum> Editing::minimise(const FlattenOptions& options, const Monitor& monitor, Mending mending,
                                  bool begins_near) {
  const std::vector<Vec2> rotation = begins_near ? std::vector<Vec2>() : closest_rotations();
  DofMap dof(nodes_);
  std::vector<Vec2> near = pool_.copy(uv_);
  for (const auto& [v, z] : nodes_.place) near[v] = z;
  ArapProblem arap = problem(*global_, nodes_, dof, rotation);
  arap.local = &*local_;
  arap.pool = &pool_;
  arap.near = near;
  // A map without flips is not given up for one that may have some.
  arap.begins_near = begins_near || (mending == Mending::Watched && is_injective(arap, near));
  if (has_features()) {
    arap.most_untangling_steps = kHeldUntanglingSteps;
    arap.untangles_first_map = false;
  }
  auto minimum = lower(arap, options, monitor, mending, held_starts(arap, options, monitor));
  pool_.give(std::move(near));
  return minimum;
}

/// Local/global, and where asked for the removal of flips, the descent without them, and the removal of overlaps.
Result<Minimum> Editing::lower(const ArapProblem& arap, const FlattenOptions& options, const Monitor& monitor,
                               Mending mending, const OverlapFreeStarts& starts) {
  Minimum minimum;
  const auto iterate = [&](Watch watch) {
    return timed(Phase::LocalGlobal, monitor, [&]() -> Result<void> {
      auto result = minimise_arap(exec_, arap, options, monitor, watch);
      if (!result) return fail(result.error());
      minimum = std::move(*result);
      return {};
    });
  };
  auto done = iterate(mending == Mending::Watched ? Watch::Injectivity : Watch::None);
  if (mending == Mending::None || !done)
    return done ? Result<Minimum>(std::move(minimum)) : fail(done.error());
  if (mending == Mending::AtEnd) {
    minimum.injective = is_injective(arap, minimum.uv);
    if (!minimum.injective) done = iterate(Watch::Injectivity);
  }
  if (done && !(mending == Mending::AtEnd && minimum.injective))
    done =
        timed(Phase::Untangle, monitor, [&] { return remove_flips(exec_, arap, options, monitor, minimum); });
  if (done)
    done = timed(Phase::Polish, monitor, [&] { return polish(exec_, arap, options, monitor, minimum); });
  if (done && options.overlaps == Overlapping::Remove)
    done = timed(Phase::Separate, monitor,
                 [&] { return remove_overlaps(exec_, arap, starts, options, monitor, minimum); });
  if (!done) return fail(done.error());
  return minimum;
}

void Editing::keep(Minimum minimum) {
  uv_.swap(minimum.uv);
  pool_.give(std::move(minimum.uv));
  solved_.history = std::move(minimum.history);
  solved_.iterations = solved_.history.back().iteration;
  solved_.converged = minimum.converged;
  solved_.gradient = minimum.gradient;
  solved_.removal = minimum.removal;
  solved_.removal.method = last_.flips;
  solved_.overlaps = minimum.overlaps;
  solved_.overlaps.method = last_.overlaps;
}

/// What nothing ties to a place lies as near to the given map as it can.
void Editing::settle_gauge() {
  const std::vector<std::uint8_t> loose = components_that_turn();
  if (std::find(loose.begin(), loose.end(), 1) == loose.end()) return;
  std::vector<Freedom> freedom;
  for (const std::uint8_t turns : loose) freedom.push_back(turns ? Freedom::Isometry : Freedom::None);
  std::vector<Placement> motion = onto_map(freedom, piece_.component, uv_, aligned_);
  if (system_) {
    for (const Pin& pin : system_->pins()) {
      const Index k = piece_.component[pin.vertex];
      if (loose[k]) motion[k].p = pin.uv - multiply(motion[k].c, pin.uv);  // the only one: a turn about it
    }
  }
  move_components(motion, piece_.component, uv_);
  if (!system_) return;
  for (const Pin& pin : system_->pins()) uv_[pin.vertex] = pin.uv;
}

ArapProblem Editing::problem(GlobalPhase& global, const NodeMap& nodes, DofMap& dof,
                             In<Vec2> rotation) const {
  ArapProblem arap = piece_.problem(global, nodes, dof, dof, rotation);
  arap.energy.frame = rest().frame;
  arap.energy.cotangent = rest().cotangent;
  arap.energy.area = rest().area;
  arap.edge_weight = [this](Index c) { return rest().edge_weight(topology(), c); };
  arap.turns_freely = components_that_turn();
  arap.constrained = true;
  return arap;
}

std::vector<Vec2> Editing::closest_rotations() const {
  const In<Index> corner = mesh().corner_vertex;
  std::vector<Vec2> rotation(mesh().num_triangles());
  exec_.for_blocks(mesh().num_triangles(), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      const std::array<Vec2, 3> image = {uv_[corner[3 * t]], uv_[corner[3 * t + 1]], uv_[corner[3 * t + 2]]};
      rotation[t] =
          closest_rotation(image, &rest().cotangent[3 * static_cast<std::size_t>(t)], rest().frame[t]);
    }
  });
  return rotation;
}

bool Editing::is_injective(const ArapProblem& arap, In<Vec2> uv) const {
  return measure_->is_injective(uv) && arap.dof->reversed_edges() == 0;
}

/// A single held vertex does not say how its component is turned.
std::vector<std::uint8_t> Editing::components_that_turn() const {
  std::vector<Index> held(topology().num_components, 0);
  for (Index v = 0; v < mesh().num_vertices(); ++v) held[piece_.component[v]] += nodes_.fixed[v];
  std::vector<std::uint8_t> turns(held.size());
  for (std::size_t k = 0; k < held.size(); ++k) turns[k] = held[k] <= 1;
  return turns;
}

}  // namespace planish
