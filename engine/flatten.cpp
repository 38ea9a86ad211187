#include "engine/flatten.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <optional>

#include "engine/constraints/constrained_start.hpp"
#include "engine/flatten_options.hpp"
#include "engine/flatten_steps.hpp"
#include "engine/memory_need.hpp"
#include "engine/methods/deformed.hpp"
#include "engine/methods/method.hpp"
#include "engine/methods/sizes.hpp"
#include "engine/near_constraints.hpp"
#include "engine/prepare/connection.hpp"
#include "engine/solve/flip_free.hpp"
#include "engine/solve/gauge.hpp"
#include "engine/solve/overlap_free.hpp"
#include "engine/solve/start.hpp"
#include "engine/solve/tutte.hpp"
#include "engine/solve/weighted_steps.hpp"

namespace planish {
namespace {

/// One run of flatten: its steps in order, their times, and the wish to stop between them.
class Run {
 public:
  Run(const Surface& surface, const Constraints& constraints, const FlattenOptions& options,
      const Monitor& monitor)
      : surface_(surface),
        constraints_(constraints),
        options_(options),
        monitor_(monitor),
        exec_(options.threads),
        method_(find_map_method(options.method)) {}

  Result<Flattening> operator()() {
    return check()
        .and_then([&] { return compile_constraints(); })
        .and_then([&] { return order(); })
        .and_then([&] { return choose_by_memory(); })
        .and_then([&] { return method_ ? map_by_method() : start().and_then([&] { return minimise(); }); })
        .and_then([&] { return place(); })
        .map([&] { return std::move(result_); });
  }

  Result<ConstraintPlan> plan() {
    return check()
        .and_then([&] { return compile_constraints(); })
        .and_then([&] { return order(); })
        .and_then([&] { return system_ ? rotate(nullptr) : Result<void>(); })
        .and_then([&] { return count(); })
        .map([&] { return std::move(plan_); });
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Announces a step and times it.
  template <class Step>
  Result<void> timed(Phase phase, Step step) {
    if (monitor_ && monitor_({.phase = phase}) == Verdict::Stop) {
      return fail(ErrorCode::Cancelled, "stopped by the caller");
    }
    const auto begin = Clock::now();
    Result<void> done = step();
    result_.timings.push_back({name(phase), std::chrono::duration<double>(Clock::now() - begin).count()});
    return done;
  }

  Result<void> check() {
    result_.threads = exec_.threads();
    result_.method = options_.method;
    const Index num_triangles = surface_.num_triangles();
    auto fits = within_memory(memory_of_checks(num_triangles), options_.memory_limit,
                              "checking and ordering the mesh needs");
    if (!fits) return fits;
    return timed(Phase::Check, [&]() -> Result<void> {
      auto piece = make_workpiece(exec_, surface_);
      if (!piece) return fail(piece.error());
      piece_ = std::move(*piece);
      result_.mesh = mesh_facts(piece_);
      return {};
    });
  }

  // ---- constraints ----

  Result<void> compile_constraints() {
    if (constraints_.set == nullptr) {
      piece_.outer_loop = outer_loops(topology());
      nodes_ = find_nodes(piece_.component, topology().num_components);
      return {};
    }
    return timed(Phase::Compile, [&]() -> Result<void> {
      features_ = features_in_order(mesh(), constraints_.features);
      piece_.find_loops();
      auto outer = choose_outer(piece_, features_, constraints_.set->outer);
      if (!outer) return fail(outer.error());
      piece_.outer_loop = std::move(*outer);
      if (constraints_.set->constraints.empty()) {
        nodes_ = find_nodes(piece_.component, topology().num_components);
        return {};
      }
      view_ = {constraints_.set, features_, constraints_.vertex_origin};
      if (method_) {
        auto loosened = loosen(*method_, *constraints_.set);
        if (!loosened) return fail(loosened.error());
        loosened_ = std::move(loosened->set);
        result_.up_to_scale = std::move(loosened->up_to_scale);
        view_.set = &loosened_;
      }
      auto system = ConstraintSystem::make(
          piece_.rest(), view_,
          [&](const Surface& region) { return map_region(region, options_.threads, monitor_); },
          piece_.component);
      if (!system) return fail(system.error());
      system_ = std::move(*system);
      nodes_ = system_->nodes();
      return {};
    });
  }

  // ---- the map ----

  Result<void> order() {
    return timed(Phase::Order, [&]() -> Result<void> {
      laplacian_ =
          system_ ? piece_.laplacian_over(exec_, nodes_) : piece_.held_laplacian(exec_, nodes_.fixed);
      // The rotation problem needs an order of all vertices, whatever constraints merge.
      auto order = fill_reducing_order(exec_, system_ ? piece_.whole_laplacian(exec_) : laplacian_);
      if (!order) return fail(order.error());
      piece_.order = std::move(*order);
      return {};
    });
  }

  Result<void> choose_by_memory() {
    if (options_.memory_limit == 0) return {};
    const auto nonzeros = factor_nonzeros(laplacian_, piece_.order);
    if (!nonzeros) return fail(nonzeros.error());
    need_ = memory_need(mesh().num_triangles(), factors() * *nonzeros, 0);
    return within_memory(need_.local_global, options_.memory_limit,
                         method_ ? "the map needs" : "local/global needs");
  }
  /// In factors of the Laplacian; methods other than ARAP couple u and v in one of four times the size beside it.
  Offset factors() const { return method_ ? 3 : 1; }
  bool fits(Offset bytes) const { return options_.memory_limit == 0 || bytes <= options_.memory_limit; }

  /// The rotation problem has the same pattern where nothing is merged: one analysis and one factor's memory serve for both.
  /// Else the two do not depend on one another: both at once where there is memory, or the first one gone before the second.
  Result<void> start() {
    return timed(Phase::Start, [&]() -> Result<void> {
      Result<GlobalPhase> global = fail({});
      Result<void> rotations;
      const auto analyse = [&] { global = GlobalPhase::analyse(exec_, laplacian_, piece_.order); };
      if (has_one_pattern()) {
        analyse();
        if (global) rotations = rotate(&*global);
      } else if (const auto turn = [&] { rotations = rotate(nullptr); }; fits(need_.at_once)) {
        exec_.both(turn, analyse);
      } else {
        turn();
        analyse();
      }
      if (!rotations) return rotations;
      if (!global) return fail(global.error());
      if (auto factored = global->refactor(exec_, laplacian_); !factored) return factored;
      global_.emplace(std::move(*global));
      laplacian_ = {};
      result_.mesh.outer = piece_.outer_loop;
      return system_ ? start_constrained() : Result<void>();
    });
  }

  /// The rotation problem's and that of the positions: neither constraints nor holes merge vertices.
  bool has_one_pattern() const {
    const bool solves_rows = options_.init == Init::Uniform || options_.init == Init::Cotangent;
    return !system_ && solves_rows && topology().num_loops() == topology().num_components;
  }

  Result<void> rotate(GlobalPhase* analysed) {
    if (system_) return system_->orient(exec_, piece_.start_input(), options_.init);
    auto rotations = first_rotations(exec_, piece_.start_input(), options_.init, analysed);
    if (!rotations) return fail(rotations.error());
    start_.rotation = std::move(rotations->rotation);
    start_.first = std::make_unique<DofMap>(nodes_);
    result_.holonomy_residual = rotations->holonomy_residual;
    return {};
  }

  Result<void> start_constrained() {
    auto start = constrained_start(exec_, piece_, *system_, *global_, options_, monitor_);
    if (!start) return fail(start.error());
    start_ = std::move(*start);
    result_.holonomy_residual = system_->holonomy_residual();
    result_.constraints = constraint_facts(*system_, start_.last(), global_->factor_nonzeros());
    return {};
  }

  /// Another method in place of start and descent; features begin where the first rotations have them.
  Result<void> map_by_method() {
    std::vector<Vec2> first;
    MapInput input{.exec = exec_, .piece = piece_};
    if (system_) {
      if (auto started = start(); !started) return started;
      FlattenOptions no_steps = options_;
      no_steps.max_iterations = 0;
      auto map = minimise_arap(
          exec_, piece_.problem(*global_, nodes_, *start_.first, start_.last(), start_.rotation), no_steps,
          {});
      if (!map) return fail(map.error());
      global_.reset();
      first = std::move(map->uv);
      input.view = &view_;
      input.system = system_.get();
      input.dof = &start_.last();
      input.first = first;
    }
    laplacian_ = {};
    return timed(Phase::Map, [&]() -> Result<void> {
      auto map = method_->map(input, monitor_);
      if (!map) return fail(map.error());
      uv_ = std::move(map->uv);
      result_.iterations = map->iterations;
      result_.intrinsic = map->intrinsic;
      result_.converged = true;
      result_.removal.method = Flips::Keep;
      result_.mesh.outer = piece_.outer_loop;
      if (!method_->any_size) return {};
      fit_sizes(piece_, system_ ? In<Pin>(system_->pins()) : In<Pin>(), has_scale_groups(), uv_);
      return {};
    });
  }
  bool has_scale_groups() const {
    return system_ && std::ranges::any_of(system_->compiled().bodies,
                                          [](const Body& body) { return !body.scale_group.empty(); });
  }

  Result<Minimum> minimum_of(const ArapProblem& arap) {
    if (!weighs_flips()) {
      return minimise_arap(exec_, arap, options_, monitor_,
                           removes_flips() ? Watch::Injectivity : Watch::None);
    }
    const std::vector<std::uint8_t> settled =
        system_ && options_.paper ? system_->triangles_at_features() : std::vector<std::uint8_t>();
    return weighted_global_steps(exec_, arap, settled, options_, monitor_);
  }
  bool weighs_flips() const {
    return options_.paper || options_.flips == Flips::Weights || options_.flips == Flips::Stiffening;
  }
  bool removes_flips() const { return !weighs_flips() && options_.flips == Flips::Untangle; }

  /// Components that nothing says how to turn.
  std::vector<std::uint8_t> components_that_turn() const {
    std::vector<std::uint8_t> turns(topology().num_components, 1);
    if (!system_) return turns;
    std::vector<Index> pins(topology().num_components, 0);
    for (const Pin& pin : system_->pins()) ++pins[piece_.component[pin.vertex]];
    for (Index k = 0; k < topology().num_components; ++k) turns[k] = !system_->directed()[k] && pins[k] < 2;
    if (options_.keep_directions) {
      for (const Body& body : system_->compiled().bodies) turns[piece_.component[body.vertex.front()]] = 0;
    }
    return turns;
  }

  Result<void> minimise() {
    ArapProblem arap = piece_.problem(*global_, nodes_, *start_.first, start_.last(), start_.rotation);
    arap.turns_freely = components_that_turn();
    arap.newton_fits = fits(need_.newton);
    if (!system_) arap.last_resort = [this] { return tutte_map(exec_, piece_.start_input()); };
    Minimum minimum;
    const auto found = [&]() -> Result<void> {
      auto result = minimum_of(arap);
      if (!result) return fail(result.error());
      minimum = std::move(*result);
      return {};
    };
    auto done = timed(Phase::LocalGlobal, found);
    if (done && removes_flips() && !(minimum.injective && minimum.converged))
      done = within_memory(need_.newton, options_.memory_limit, "without flips kept, Newton steps need");
    if (done && removes_flips()) {
      done = timed(Phase::Untangle, [&] { return remove_flips(exec_, arap, options_, monitor_, minimum); });
      global_.reset();
      if (done) done = timed(Phase::Polish, [&] { return polish(exec_, arap, options_, monitor_, minimum); });
      if (done && overlapping(options_) == Overlapping::Remove)
        done = timed(Phase::Separate, [&] { return separate(arap, minimum); });
    }
    if (!done) return done;
    global_.reset();
    uv_ = std::move(minimum.uv);
    result_.history = std::move(minimum.history);
    result_.iterations = result_.history.back().iteration;
    result_.converged = minimum.converged;
    result_.gradient = minimum.gradient;
    result_.removal = minimum.removal;
    result_.removal.method = options_.paper ? Flips::Weights : options_.flips;
    result_.overlaps = minimum.overlaps;
    result_.overlaps.method = overlapping(options_);
    return system_ ? system_->check_scales(*start_.last().poses()) : Result<void>();
  }

  Result<void> separate(const ArapProblem& arap, Minimum& minimum) {
    OverlapFreeStarts starts{.first_map = [&] { return first_map(arap); }};
    if (!system_) starts.convex_map = arap.last_resort;
    if (system_) {
      starts.unconstrained_map = [this] { return unconstrained_map(); };
      starts.near_constraints = [this](std::vector<Vec2> uv) { return near_constraints(std::move(uv)); };
    }
    auto done = remove_overlaps(exec_, arap, starts, options_, monitor_, minimum);
    if (minimum.overlaps.start != OverlapRemoval::Start::Unconstrained) return done;
    start_.first.reset();
    start_.free = std::move(near_dof_);  // the features lie as it has them
    system_ = std::move(near_system_);
    return done;
  }

  /// A map moved so that features in their shapes lie where they fit it best.
  Result<OverlapFreeStarts::NearConstraints> near_constraints(std::vector<Vec2> uv) {
    near_system_ = std::make_unique<ConstraintSystem>(*system_);
    auto near = planish::near_constraints(piece_, *near_system_, std::move(uv));
    if (!near) return fail(near.error());
    near_dof_ = std::move(near->dof);
    return OverlapFreeStarts::NearConstraints{{std::move(near->uv), std::move(near->place)}, near_dof_.get()};
  }

  /// In the units and the order of the mesh here.
  Result<std::vector<Vec2>> unconstrained_map() const {
    FlattenOptions options = options_;
    options.normalize = false;
    ConstraintSet none = *constraints_.set;
    none.constraints.clear();
    Constraints outer_alone = constraints_;
    outer_alone.set = &none;
    auto flat = planish::flatten(surface_, outer_alone, options, monitor_);
    if (!flat) return fail(flat.error());
    std::vector<Vec2> uv;
    for (const Index v : mesh().vertex_origin) uv.push_back((1 / mesh().unit) * flat->uv[v]);
    return uv;
  }

  Result<OverlapFreeStarts::Map> first_map(ArapProblem arap) const {
    auto first = new_dof_map(true), last = new_dof_map(options_.keep_directions);
    if (!first) return fail(first.error());
    if (!last) return fail(last.error());
    auto global = piece_.factor(exec_, piece_.laplacian_over(exec_, nodes_));
    if (!global) return fail(global.error());
    arap.global = &*global;
    arap.first = first->get();
    arap.dof = last->get();
    FlattenOptions no_steps = options_;
    no_steps.max_iterations = 0;
    auto map = minimise_arap(exec_, arap, no_steps, monitor_);
    if (!map) return fail(map.error());
    return OverlapFreeStarts::Map{std::move(map->uv), std::move(*last)};
  }

  /// At the start, its directions free or as the first rotations have them.
  Result<std::unique_ptr<DofMap>> new_dof_map(bool frozen) const {
    return system_ ? system_->dof_map(frozen) : std::make_unique<DofMap>(nodes_);
  }

  /// Gauge, layout, units; then everything is measured on the final coordinates.
  Result<void> place() {
    return timed(Phase::Measure, [&]() -> Result<void> {
      for (Vec2& z : uv_) z = mesh().unit * z;
      std::vector<std::uint8_t> directed(topology().num_components, 0), pinned = directed;
      if (system_) {
        directed.assign(system_->directed().begin(), system_->directed().end());
        for (const Pin& pin : system_->pins()) pinned[piece_.component[pin.vertex]] = 1;
      }
      centre_and_align(mesh().corner_vertex, {piece_.component, directed, pinned}, mesh().vertex_origin, uv_);
      if (topology().num_components > 1) lay_out({piece_.component, directed, pinned}, uv_);
      if (options_.normalize) fit_into_unit_square();
      if (system_) result_.constraints.outcome = system_->outcomes(uv_);
      result_.certificate = measure_map(exec_, piece_, uv_);
      result_.uv = in_input_order(mesh(), uv_);
      return {};
    });
  }

  void fit_into_unit_square() {
    Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
    for (const Vec2 z : uv_) {
      lower = {std::min(lower.x, z.x), std::min(lower.y, z.y)};
      upper = {std::max(upper.x, z.x), std::max(upper.y, z.y)};
    }
    const double scale = 1 / std::max(upper.x - lower.x, upper.y - lower.y);
    for (Vec2& z : uv_) z = scale * (z - lower);
  }

  /// What a solve would take: the factor in its supernodes, and the columns beside it.
  Result<void> count() {
    auto nonzeros = factor_nonzeros(laplacian_, piece_.order);
    if (!nonzeros) return fail(nonzeros.error());
    plan_.mesh = result_.mesh;
    plan_.mesh.outer = piece_.outer_loop;
    for (Index v = 0; v < mesh().num_vertices(); ++v) plan_.unknowns += nodes_.node[v] == v;
    plan_.unknowns += nodes_.num_nodes - mesh().num_vertices();
    plan_.facts.factor_nonzeros = *nonzeros;
    if (system_) {
      auto dof = system_->dof_map(false);
      if (!dof) return fail(dof.error());
      if (auto few = check_border(**dof); !few) return few;
      plan_.facts = constraint_facts(*system_, **dof, *nonzeros);
    }
    const MemoryNeed need =
        memory_need(mesh().num_triangles(), factors() * *nonzeros, plan_.facts.border_unknowns);
    plan_.memory_bytes = !has_one_pattern() && fits(need.at_once) ? need.at_once : need.local_global;
    plan_.newton_bytes = method_ ? 0 : std::max(plan_.memory_bytes, need.newton);
    return within_memory(need.local_global, options_.memory_limit,
                         method_ ? "the map needs" : "local/global needs");
  }

  const OrderedMesh& mesh() const { return piece_.mesh(); }
  const Topology& topology() const { return piece_.topology(); }

  const Surface surface_;
  const Constraints constraints_;
  const FlattenOptions options_;
  const Monitor& monitor_;
  Exec exec_;
  const MapMethod* method_;  // null: ARAP
  Workpiece piece_;
  std::vector<Feature> features_;  // in the numbers of the ordered mesh
  ConstraintSet loosened_;         // what the method can express of the constraints
  ConstraintView view_;
  std::unique_ptr<ConstraintSystem> system_;  // none without constraints
  NodeMap nodes_;
  SymmetricMatrix laplacian_;
  std::optional<GlobalPhase> global_;
  ConstrainedStart start_;
  std::unique_ptr<ConstraintSystem> near_system_;  // oriented at the map without constraints
  std::unique_ptr<DofMap> near_dof_;
  std::vector<Vec2> uv_;  // [V] of the ordered mesh
  Flattening result_;
  ConstraintPlan plan_;
  MemoryNeed need_;  // filled where memory is limited
};

template <class Work>
auto with_memory(const Surface& surface, Work work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory,
                "not enough memory to flatten " + std::to_string(surface.num_triangles()) + " triangles");
  }
}

}  // namespace

Result<Flattening> flatten(const Surface& surface, const FlattenOptions& options, const Monitor& monitor) {
  return flatten(surface, Constraints{}, options, monitor);
}

Result<Flattening> flatten(const Surface& surface, const Constraints& constraints,
                           const FlattenOptions& options, const Monitor& monitor) {
  if (auto checked = check_options(options); !checked) return fail(checked.error());
  if (options.normalize && constraints.set != nullptr && !constraints.set->constraints.empty())
    return fail(ErrorCode::BadUsage, "normalize would change the sizes that constraints prescribe");
  if (options.method == Method::Deform)
    return with_memory(surface, [&] { return flatten_and_deform(surface, constraints, options, monitor); });
  return with_memory(surface, [&] { return Run(surface, constraints, options, monitor)(); });
}

Result<ConstraintPlan> plan(const Surface& surface, const Constraints& constraints,
                            const FlattenOptions& options, const Monitor& monitor) {
  if (auto checked = check_options(options); !checked) return fail(checked.error());
  return with_memory(surface, [&] { return Run(surface, constraints, options, monitor).plan(); });
}

}  // namespace planish
