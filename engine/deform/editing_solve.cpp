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

}  // namespace

FlattenOptions Editing::flatten_options(const SolveOptions& options) const {
  FlattenOptions result;
  result.energy = options.energy;
  result.flips = options.flips;
  result.tolerance = options.tolerance;
  result.max_iterations = options.max_iterations;
  result.threads = options_.threads;
  return result;
}

Result<void> Editing::solve(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  const std::vector<Vec2> before = uv_;
  auto solved = go_on(options, monitor, sink);
  if (solved) return solved;
  uv_ = before;
  settled_ = false;
  return solved;
}

Result<void> Editing::go_on(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  last_ = options;
  if (auto factored = timed(Phase::Start, monitor, [&] { return factor(); }); !factored) return factored;
  const std::vector<Vec2> start = uv_;
  const auto say_step = [&](int step) { return sink ? sink(snapshot(step)) : Result<void>(); };
  if (auto taken = say_step(0); !taken) return taken;
  release_ = Release::None;
  settled_ = settled_ && options.steps == 1;
  auto minimum = follow(options, monitor, say_step);
  const bool has_features = system_ && !system_->compiled().bodies.empty();
  if (minimum && options.flips == Flips::Untangle && !minimum->injective && has_features) {
    uv_ = start;
    settled_ = false;
    minimum = let_go(std::move(*minimum), options, monitor);
  }
  if (!minimum) return fail(minimum.error());
  settled_ = minimum->injective && release_ == Release::None;
  keep(std::move(*minimum));
  settle_gauge();
  return say_step(options.steps);
}

/// From where the map is, step by step, all but the last one told.
Result<Minimum> Editing::follow(const SolveOptions& options, const Monitor& monitor,
                                const std::function<Result<void>(int)>& say_step) {
  std::optional<FeatureMotion> motion;
  if (system_) motion.emplace(*system_, *placed_, uv_);
  for (int step = 1;; ++step) {
    nodes_.place.clear();
    if (motion) nodes_.place = motion->at(static_cast<double>(step) / options.steps);
    for (const Index v : alone_) nodes_.place.emplace_back(v, uv_[v]);
    const bool last = step == options.steps;
    auto minimum = minimise(options, monitor, last);
    if (!minimum || last) return minimum;
    uv_ = std::move(minimum->uv);
    if (auto taken = say_step(step); !taken) return fail(taken.error());
  }
}

/// With what is held where it is to be.
Result<Minimum> Editing::minimise(const SolveOptions& options, const Monitor& monitor, bool last) {
  const std::vector<Vec2> rotation = closest_rotations();
  DofMap dof(nodes_);
  std::vector<Vec2> near = uv_;
  for (const auto& [v, z] : nodes_.place) near[v] = z;
  ArapProblem arap = problem(*global_, nodes_, dof, rotation);
  arap.near = near;
  FlattenOptions chosen = flatten_options(options);
  if (!last) {
    chosen.tolerance = std::max(chosen.tolerance, kWayTolerance);
    chosen.max_iterations = std::min(chosen.max_iterations, kWayIterations);
  }
  return lower(arap, chosen, monitor, last && options.flips == Flips::Untangle);
}

/// Local/global, and where asked for the removal of flips and the descent without them.
Result<Minimum> Editing::lower(const ArapProblem& arap, const FlattenOptions& options, const Monitor& monitor,
                               bool mending) {
  Minimum minimum;
  const auto iterate = [&](Watch watch) {
    return timed(Phase::LocalGlobal, monitor, [&]() -> Result<void> {
      auto result = minimise_arap(exec_, arap, options, monitor, watch);
      if (!result) return fail(result.error());
      minimum = std::move(*result);
      return {};
    });
  };
  // Watching every step costs a third of it. Near a minimum without flips one look at the end does.
  auto done = iterate(mending && !settled_ ? Watch::Injectivity : Watch::None);
  if (done && mending && settled_) {
    minimum.injective = minimum.converged && is_injective(arap, minimum.uv);
    if (!minimum.injective) done = iterate(Watch::Injectivity);
  }
  if (done && mending && !(settled_ && minimum.injective))
    done =
        timed(Phase::Untangle, monitor, [&] { return remove_flips(exec_, arap, options, monitor, minimum); });
  if (done && mending)
    done = timed(Phase::Polish, monitor, [&] { return polish(exec_, arap, options, monitor, minimum); });
  if (!done) return fail(done.error());
  return minimum;
}

void Editing::keep(Minimum minimum) {
  uv_ = std::move(minimum.uv);
  solved_.history = std::move(minimum.history);
  solved_.iterations = solved_.history.back().iteration;
  solved_.converged = minimum.converged;
  solved_.gradient = minimum.gradient;
  solved_.removal = minimum.removal;
  solved_.removal.method = last_.flips;
}

/// What nothing ties to a place lies as near to the given map as it can.
void Editing::settle_gauge() {
  const std::vector<std::uint8_t> loose = components_that_turn();
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
  return MapEnergy(exec_, arap.energy).is_injective(uv) && arap.dof->reversed_edges() == 0;
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
