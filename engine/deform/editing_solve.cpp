// Solving an edited map: constrained elements held, the rest as rigid as possible, flips removed.
#include <algorithm>

#include "engine/deform/editing.hpp"
#include "engine/flatten_steps.hpp"
#include "engine/solve/flip_free.hpp"
#include "engine/verify/certificate.hpp"
#include "kernels/local/proxy.hpp"

namespace planish {
namespace {

/// A step on the way need not be exact: the next one begins there.
constexpr double kWayTolerance = 1e-3;
constexpr int kWayIterations = 20;

FlattenOptions options_of(const SolveOptions& options, int threads) {
  FlattenOptions result;
  result.energy = options.energy;
  result.flips = options.flips;
  result.tolerance = options.tolerance;
  result.max_iterations = options.max_iterations;
  result.threads = threads;
  return result;
}

}  // namespace

Result<void> Editing::solve(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  const std::vector<Vec2> before = uv_;
  auto solved = go_on(options, monitor, sink);
  if (!solved) uv_ = before;
  return solved;
}

Result<void> Editing::go_on(const SolveOptions& options, const Monitor& monitor, const StepSink& sink) {
  last_ = options;
  solved_.history.clear();
  released_ = false;
  if (auto factored = timed(Phase::Start, monitor, [&] { return factor(); }); !factored) return factored;
  std::optional<FeatureMotion> motion;
  if (system_) motion.emplace(*system_, *placed_, uv_);
  const auto say_step = [&](int step) { return sink ? sink(snapshot(step)) : Result<void>(); };
  if (auto taken = say_step(0); !taken) return taken;
  for (int step = 1; step <= options.steps; ++step) {
    nodes_.place.clear();
    if (motion) nodes_.place = motion->at(static_cast<double>(step) / options.steps);
    for (const Index v : alone_) nodes_.place.emplace_back(v, uv_[v]);
    if (auto done = minimise(options, monitor, step == options.steps); !done) return done;
    if (step == options.steps) settle_gauge();
    if (auto taken = say_step(step); !taken) return taken;
  }
  return {};
}

Result<void> Editing::minimise(const SolveOptions& options, const Monitor& monitor, bool last) {
  const std::vector<Vec2> rotation = closest_rotations();
  DofMap dof(nodes_);
  const ArapProblem arap = problem(*global_, nodes_, dof, rotation);
  FlattenOptions chosen = options_of(options, options_.threads);
  if (!last) {
    chosen.tolerance = std::max(chosen.tolerance, kWayTolerance);
    chosen.max_iterations = std::min(chosen.max_iterations, kWayIterations);
  }
  const bool remove = last && options.flips == Flips::Untangle;
  Minimum minimum;
  auto found = timed(Phase::LocalGlobal, monitor, [&]() -> Result<void> {
    auto result = minimise_arap(exec_, arap, chosen, monitor, remove ? Watch::Injectivity : Watch::None);
    if (!result) return fail(result.error());
    minimum = std::move(*result);
    return {};
  });
  if (found && remove) found = remove_faults(arap, chosen, monitor, minimum);
  if (!found) return found;
  keep(std::move(minimum));
  return {};
}

Result<void> Editing::remove_faults(const ArapProblem& arap, const FlattenOptions& options,
                                    const Monitor& monitor, Minimum& minimum) {
  auto done =
      timed(Phase::Untangle, monitor, [&] { return remove_flips(exec_, arap, options, monitor, minimum); });
  if (done && !minimum.injective && system_ && !system_->compiled().bodies.empty())
    return release(options, monitor, minimum);
  if (!done) return done;
  return timed(Phase::Polish, monitor, [&] { return polish(exec_, arap, options, monitor, minimum); });
}

/// Features as unknowns, as flatten has them, from where they were held.
Result<void> Editing::release(const FlattenOptions& options, const Monitor& monitor, Minimum& minimum) {
  auto poses = system_->poses_at(aligned_);
  if (!poses) return fail(poses.error());
  const NodeMap& nodes = system_->nodes();
  DofMap dof(nodes, system_->owners(), system_->assemblies(), std::move(*poses));
  auto global = GlobalPhase::factor(
      quotient_laplacian(exec_, mesh().corner_vertex, topology(), nodes.node, nodes.num_nodes,
                         [&](Index c) { return rest().edge_weight(topology(), c); }),
      piece_.order);
  if (!global) return fail(global.error());

  // What this DOF map holds lies at 0, so components move there and back.
  std::vector<Vec2> origin(topology().num_components);
  for (Index v = 0; v < mesh().num_vertices(); ++v) {
    if (nodes.node[v] == kNone) origin[piece_.component[v]] = minimum.uv[v];
  }
  for (const Owner& owner : system_->owners()) {
    const Index assembly = system_->assemblies().of[owner.body];
    if (nodes.assembly_node[assembly] == kNone)
      origin[piece_.component[owner.vertex]] = placed_->shift[assembly];
  }
  for (const Pin& pin : system_->pins()) origin[piece_.component[pin.vertex]] = {};
  for (Index v = 0; v < mesh().num_vertices(); ++v) minimum.uv[v] += -origin[piece_.component[v]];

  const std::vector<Vec2> rotation = closest_rotations();
  const ArapProblem arap = problem(*global, nodes, dof, rotation);
  auto done =
      timed(Phase::Untangle, monitor, [&] { return remove_flips(exec_, arap, options, monitor, minimum); });
  if (done)
    done = timed(Phase::Polish, monitor, [&] { return polish(exec_, arap, options, monitor, minimum); });
  for (Index v = 0; v < mesh().num_vertices(); ++v) minimum.uv[v] += origin[piece_.component[v]];
  released_ = true;
  return done ? system_->check_scales(*dof.poses()) : done;
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
  std::vector<Index> held(topology().num_components, 0);
  for (Index v = 0; v < mesh().num_vertices(); ++v) held[piece_.component[v]] += nodes_.fixed[v];
  std::vector<std::uint8_t> loose(held.size(), 0);
  for (std::size_t k = 0; k < held.size(); ++k) loose[k] = held[k] == 1;
  std::vector<Placement> motion = onto_map(loose, piece_.component, uv_, aligned_);
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

/// A single held vertex does not say how its component is turned.
std::vector<std::uint8_t> Editing::components_that_turn() const {
  std::vector<Index> held(topology().num_components, 0);
  for (Index v = 0; v < mesh().num_vertices(); ++v) held[piece_.component[v]] += nodes_.fixed[v];
  std::vector<std::uint8_t> turns(held.size());
  for (std::size_t k = 0; k < held.size(); ++k) turns[k] = held[k] <= 1;
  return turns;
}

}  // namespace planish
