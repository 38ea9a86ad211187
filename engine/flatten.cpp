#include "engine/flatten.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <numeric>
#include <optional>

#include "engine/constraints/fit.hpp"
#include "engine/constraints/system.hpp"
#include "engine/prepare/connection.hpp"
#include "engine/prepare/geometry.hpp"
#include "engine/solve/driver.hpp"
#include "engine/solve/gauge.hpp"
#include "engine/solve/laplacian.hpp"
#include "engine/solve/start.hpp"
#include "engine/solve/weighted_steps.hpp"
#include "engine/verify/certificate.hpp"
#include "engine/verify/overlaps.hpp"

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
        exec_(options.threads) {}

  Result<Flattening> operator()() {
    return check()
        .and_then([&] { return compile_constraints(); })
        .and_then([&] { return order(); })
        .and_then([&] { return start(); })
        .and_then([&] { return minimise(); })
        .and_then([&] { return place(); })
        .map([&] { return std::move(result_); });
  }

  Result<ConstraintPlan> plan() {
    return check()
        .and_then([&] { return compile_constraints(); })
        .and_then([&]() -> Result<void> {
          // Directions along a spanning tree: what contradicts itself does so whatever the rotations are.
          return system_ ? system_->orient(exec_, start_input(), Init::Identity) : Result<void>();
        })
        .and_then([&] { return order(); })
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
    return timed(Phase::Check, [&]() -> Result<void> {
      auto prepared = prepare(exec_, surface_);
      if (!prepared) return fail(prepared.error());
      if (!prepared->diagnosis.usable()) return fail(refusal(prepared->diagnosis));
      prepared_ = std::move(*prepared);
      geometry_ = measure_geometry(exec_, prepared_);
      component_ = vertex_components(topology(), mesh().num_vertices());
      const Diagnosis& diagnosis = prepared_.diagnosis;
      result_.mesh = {.vertices = diagnosis.vertices,
                      .unreferenced_vertices = diagnosis.unreferenced_vertices,
                      .duplicate_positions = diagnosis.duplicate_positions,
                      .triangles = diagnosis.triangles,
                      .components = diagnosis.components,
                      .boundary_loops = diagnosis.boundary_loops,
                      .euler = diagnosis.euler,
                      .outer = {},
                      .mollified_triangles = static_cast<Index>(
                          std::count(geometry_.mollified.begin(), geometry_.mollified.end(), 1))};
      return {};
    });
  }

  // ---- constraints ----

  Result<void> compile_constraints() {
    if (constraints_.set == nullptr) {
      outer_loop_ = outer_loops(topology());
      nodes_ = find_nodes(component_, topology().num_components);
      return {};
    }
    return timed(Phase::Compile, [&]() -> Result<void> {
      number_features();
      loop_of_.assign(mesh().num_vertices(), kNone);
      for (Index l = 0; l < topology().num_loops(); ++l) {
        for (const Index c : slice(In<Index>(topology().loop_corner), topology().loops().group(l)))
          loop_of_[mesh().corner_vertex[c]] = l;
      }
      if (auto chosen = choose_outer(); !chosen) return chosen;
      if (constraints_.set->constraints.empty()) {
        nodes_ = find_nodes(component_, topology().num_components);
        return {};
      }
      rest_ = {&mesh(), &topology(), geometry_.frame, outer_loop_, loop_of_};
      view_ = {constraints_.set, features_, constraints_.vertex_origin};
      auto system = ConstraintSystem::make(
          rest_, view_, [&](const Surface& region) { return map_region(region); }, component_);
      if (!system) return fail(system.error());
      system_ = std::move(*system);
      nodes_ = system_->nodes();
      return {};
    });
  }

  /// The features' ids in the ordered mesh.
  void number_features() {
    std::vector<Index> vertex(mesh().num_input_vertices, kNone), triangle(mesh().num_triangles(), kNone);
    for (Index v = 0; v < mesh().num_vertices(); ++v) vertex[mesh().vertex_origin[v]] = v;
    for (Index t = 0; t < mesh().num_triangles(); ++t) triangle[mesh().triangle_origin[t]] = t;
    features_ = *constraints_.features;
    for (Feature& feature : features_) {
      for (Index& v : feature.vertex) v = vertex[v];
      for (Index& t : feature.triangle) t = triangle[t];
      std::sort(feature.triangle.begin(), feature.triangle.end());
    }
  }

  Result<void> choose_outer() {
    const std::string& name = constraints_.set->outer;
    Index chosen = kNone;
    if (!name.empty()) {
      const auto feature =
          std::find_if(features_.begin(), features_.end(), [&](const Feature& f) { return f.name == name; });
      const bool on_boundary =
          feature != features_.end() && !feature->is_region() && feature->closed &&
          std::all_of(feature->vertex.begin(), feature->vertex.end(), [&](Index v) {
            return loop_of_[v] != kNone && loop_of_[v] == loop_of_[feature->vertex.front()];
          });
      if (!on_boundary) {
        Error error{.code = ErrorCode::ConstraintInvalid,
                    .what = "outer: \"" + name + "\" is no boundary loop"};
        error.place.pointer = "/outer";
        return fail(error);
      }
      chosen = loop_of_[feature->vertex.front()];
    }
    outer_loop_ = outer_loops(topology(), chosen);
    return {};
  }

  Result<std::vector<Vec2>> map_region(const Surface& region) const {
    auto flat = planish::flatten(region, {.threads = options_.threads});
    if (!flat) return fail(flat.error());
    if (const Offset flips = flat->certificate.flipped_triangles; flips > 0) {
      return fail(ErrorCode::ConstraintsConflict,
                  "its own flattening turns over " + std::to_string(flips) + " triangles; make it smaller");
    }
    return std::move(flat->uv);
  }

  // ---- the first map ----

  Result<void> order() {
    return timed(Phase::Order, [&]() -> Result<void> {
      laplacian_ = laplacian_over(nodes_);
      auto order = fill_reducing_order(system_ ? whole_laplacian() : laplacian_);
      if (!order) return fail(order.error());
      order_ = std::move(*order);
      return {};
    });
  }

  /// Of all vertices, whatever constraints merge: the rotation problem needs an order of them all.
  SymmetricMatrix whole_laplacian() const {
    const std::vector<std::uint8_t> none(mesh().num_vertices(), 0);
    return vertex_laplacian(exec_, mesh().corner_vertex, topology(), none,
                            [&](Index c) { return edge_weight(c); });
  }

  SymmetricMatrix laplacian_over(const NodeMap& nodes) const {
    return quotient_laplacian(exec_, mesh().corner_vertex, topology(), nodes.node, nodes.num_nodes,
                              [&](Index c) { return edge_weight(c); });
  }

  Result<GlobalPhase> factor(const SymmetricMatrix& laplacian) const {
    std::vector<Index> order = order_;
    for (auto node = static_cast<Index>(order.size()); node < laplacian.size(); ++node) order.push_back(node);
    return GlobalPhase::factor(laplacian, order);
  }

  StartInput start_input() const {
    return {.corner_vertex = mesh().corner_vertex,
            .topology = &topology(),
            .frame = geometry_.frame,
            .cotangent = geometry_.cotangent,
            .angle_sum = geometry_.angle_sum,
            .order = order_,
            .outer_loop = outer_loop_};
  }

  /// The rotation problem and the factorization for the positions depend on the order alone: both at once.
  Result<void> start() {
    return timed(Phase::Start, [&]() -> Result<void> {
      Result<void> rotations;
      Result<GlobalPhase> global = fail({});
      exec_.both([&] { rotations = rotate(); }, [&] { global = factor(laplacian_); });
      if (!rotations) return rotations;
      if (!global) return fail(global.error());
      global_.emplace(std::move(*global));
      laplacian_ = {};
      result_.mesh.outer = outer_loop_;
      if (!system_) {
        first_dof_ = std::make_unique<DofMap>(nodes_);
        return {};
      }
      return choose_chirality().and_then([&] { return turn_onto_pins(); }).and_then([&] {
        return map_constraints();
      });
    });
  }

  Result<void> rotate() {
    if (system_) return system_->orient(exec_, start_input(), options_.init);
    auto rotations = first_rotations(exec_, start_input(), options_.init);
    if (!rotations) return fail(rotations.error());
    rotation_ = std::move(rotations->rotation);
    result_.holonomy_residual = rotations->holonomy_residual;
    return {};
  }

  Result<void> map_constraints() {
    auto first = system_->dof_map(true);
    if (!first) return fail(first.error());
    first_dof_ = std::move(*first);
    if (!options_.keep_directions && !options_.paper) {
      auto free = system_->dof_map(false);
      if (!free) return fail(free.error());
      dof_ = std::move(*free);
    }
    take_rotations(*system_);
    if (auto few = check_border(*(dof_ ? dof_ : first_dof_)); !few) return few;
    result_.holonomy_residual = system_->holonomy_residual();
    result_.constraints.bodies = static_cast<Index>(system_->compiled().bodies.size());
    result_.constraints.assemblies = system_->assemblies().size();
    result_.constraints.clusters = system_->orientation().clusters.size();
    result_.constraints.border_unknowns = (dof_ ? *dof_ : *first_dof_).num_border();
    result_.constraints.factor_nonzeros = global_->factor_nonzeros();
    return {};
  }

  /// The border is dense: more unknowns than this do not fit.
  static Result<void> check_border(const DofMap& dof) {
    constexpr Index kMostBorderUnknowns = 20'000;
    if (dof.num_border() <= kMostBorderUnknowns) return {};
    return fail(ErrorCode::TooLarge,
                "constraints leave " + std::to_string(dof.num_border()) +
                    " scales, directions and places along lines free, 20000 are allowed; keep or "
                    "scale the lengths of long lines");
  }

  void take_rotations(const ConstraintSystem& system) {
    rotation_.resize(mesh().num_triangles());
    exec_.for_blocks(mesh().num_triangles(), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) rotation_[t] = unit(system.theta()[t]);
    });
  }

  /// Templates that the surface lets lie either way round: the way of lower energy after a few steps.
  Result<void> choose_chirality() {
    for (Index b = 0; b < static_cast<Index>(system_->compiled().bodies.size()); ++b) {
      if (!system_->compiled().bodies[b].chirality_open) continue;
      const Result<double> as_it_is = trial_energy();
      if (!as_it_is && as_it_is.error().code == ErrorCode::Cancelled) return fail(as_it_is.error());
      auto mirrored = system_->mirror(b).and_then([&] { return rotate(); });
      const Result<double> other = mirrored ? trial_energy() : fail(mirrored.error());
      if (other && (!as_it_is || *other < *as_it_is)) continue;
      if (auto back = system_->mirror(b).and_then([&] { return rotate(); }); !back) return back;
      if (!as_it_is) return fail(as_it_is.error());
    }
    return {};
  }

  Result<double> trial_energy() {
    constexpr int kTrialSteps = 5;
    if (auto turned = turn_onto_pins(); !turned) return fail(turned.error());
    auto dof = system_->dof_map(true);
    if (!dof) return fail(dof.error());
    take_rotations(*system_);
    FlattenOptions few = options_;
    few.max_iterations = kTrialSteps;
    auto minimum = minimise_arap(exec_, problem(*global_, nodes_, **dof, **dof), few, monitor_);
    if (!minimum) return fail(minimum.error());
    return minimum->history.back().energy;
  }

  /// Where several pins hold a component the first map without them tells how it is to be turned.
  Result<void> turn_onto_pins() {
    std::vector<Index> pins(topology().num_components, 0);
    for (const Pin& pin : system_->pins()) ++pins[component_[pin.vertex]];
    if (std::none_of(pins.begin(), pins.end(), [](Index n) { return n > 1; })) return {};
    auto unpinned = system_->without_pins();
    if (!unpinned) return fail(unpinned.error());
    const NodeMap& nodes = (*unpinned)->nodes();
    auto global = factor(laplacian_over(nodes));
    if (!global) return fail(global.error());
    auto dof = (*unpinned)->dof_map(true);
    if (!dof) return fail(dof.error());
    take_rotations(**unpinned);
    FlattenOptions first_step = options_;
    first_step.max_iterations = 0;
    auto map = minimise_arap(exec_, problem(*global, nodes, **dof, **dof), first_step, monitor_);
    if (!map) return fail(map.error());
    std::vector<double> by(topology().num_components, 0);
    for (Index k = 0; k < topology().num_components; ++k) {
      std::vector<Vec2> from, to;
      for (const Pin& pin : system_->pins()) {
        if (component_[pin.vertex] != k) continue;
        from.push_back(map->uv[pin.vertex]);
        to.push_back(pin.uv);
      }
      if (from.size() > 1) by[k] = argument(best_placement(from, to, 0).c);
    }
    system_->turn(by);
    return {};
  }

  // ---- the minimum ----

  ArapProblem problem(GlobalPhase& global, const NodeMap& nodes, DofMap& first, DofMap& dof) const {
    return {.energy = {.corner_vertex = mesh().corner_vertex,
                       .stars = topology().stars(),
                       .star_corner = topology().star_corner,
                       .frame = geometry_.frame,
                       .cotangent = geometry_.cotangent,
                       .fixed = nodes.fixed,
                       .area = geometry_.area},
            .global = &global,
            .topology = &topology(),
            .edge_weight = [this](Index c) { return edge_weight(c); },
            .first = &first,
            .dof = &dof,
            .rotation = rotation_,
            .order = order_,
            .vertex_component = component_,
            .num_components = topology().num_components,
            .constrained = system_ != nullptr};
  }

  Result<Minimum> minimum_of(const ArapProblem& arap) {
    if (!options_.paper) return minimise_arap(exec_, arap, options_, monitor_);
    const std::vector<std::uint8_t> settled =
        system_ ? system_->triangles_at_features() : std::vector<std::uint8_t>();
    return weighted_global_steps(exec_, arap, settled, options_, monitor_);
  }

  Result<void> minimise() {
    return timed(Phase::LocalGlobal, [&]() -> Result<void> {
      auto minimum = minimum_of(problem(*global_, nodes_, *first_dof_, dof_ ? *dof_ : *first_dof_));
      if (!minimum) return fail(minimum.error());
      global_.reset();
      uv_ = std::move(minimum->uv);
      result_.history = std::move(minimum->history);
      result_.iterations = result_.history.back().iteration;
      result_.converged = minimum->converged;
      result_.gradient = minimum->gradient;
      if (system_) return system_->check_scales(*(dof_ ? *dof_ : *first_dof_).poses());
      return {};
    });
  }

  /// Gauge, layout, units; then everything is measured on the final coordinates.
  Result<void> place() {
    return timed(Phase::Measure, [&]() -> Result<void> {
      for (Vec2& z : uv_) z = mesh().unit * z;
      std::vector<std::uint8_t> directed(topology().num_components, 0), pinned = directed;
      if (system_) {
        directed.assign(system_->directed().begin(), system_->directed().end());
        for (const Pin& pin : system_->pins()) pinned[component_[pin.vertex]] = 1;
      }
      centre_and_align(mesh().corner_vertex, {component_, directed, pinned}, mesh().vertex_origin, uv_);
      if (topology().num_components > 1) lay_out({component_, directed, pinned}, uv_);
      if (options_.normalize) fit_into_unit_square();
      measure();
      result_.uv.assign(mesh().num_input_vertices, {});
      for (Index v = 0; v < mesh().num_vertices(); ++v) result_.uv[mesh().vertex_origin[v]] = uv_[v];
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

  void measure() {
    if (system_) result_.constraints.outcome = system_->outcomes(uv_, *(dof_ ? *dof_ : *first_dof_).poses());
    for (RestFrame& f : geometry_.frame) {
      f = {mesh().unit * f.x1, mesh().unit * f.x2, mesh().unit * f.y2};
    }
    Certificate& certificate = result_.certificate;
    certificate = certify(exec_, mesh().surface(), topology(), geometry_.frame, uv_);
    to_input_ids(certificate.flipped, mesh().triangle_origin);
    to_input_ids(certificate.overwound, mesh().vertex_origin);
    const Overlaps overlaps = find_overlaps(exec_, mesh().corner_vertex, uv_);
    certificate.overlapping_pairs = overlaps.pairs;
    certificate.overlap_area_fraction = overlaps.map_area > 0 ? overlaps.common_area / overlaps.map_area : 0;
  }

  static void to_input_ids(std::vector<Index>& ids, In<Index> origin) {
    for (Index& id : ids) id = origin[id];
    std::sort(ids.begin(), ids.end());
  }

  /// What a solve would take: the factor in its supernodes, and the columns beside it.
  Result<void> count() {
    auto nonzeros = factor_nonzeros(laplacian_, order_);
    if (!nonzeros) return fail(nonzeros.error());
    plan_.mesh = result_.mesh;
    plan_.mesh.outer = outer_loop_;
    plan_.unknowns = nodes_.num_nodes;
    plan_.facts.factor_nonzeros = *nonzeros;
    if (system_) {
      auto dof = system_->dof_map(false);
      if (!dof) return fail(dof.error());
      plan_.facts.bodies = static_cast<Index>(system_->compiled().bodies.size());
      plan_.facts.assemblies = system_->assemblies().size();
      plan_.facts.clusters = system_->orientation().clusters.size();
      plan_.facts.border_unknowns = (*dof)->num_border();
      if (auto few = check_border(**dof); !few) return few;
    }
    constexpr Offset kBytesATriangle = 480;  // columns of the mesh and of the iteration, measured
    plan_.memory_bytes = kBytesATriangle * mesh().num_triangles() + 2 * 8 * *nonzeros;
    return {};
  }

  double edge_weight(Index c) const { return geometry_.edge_weight(topology(), c); }
  const OrderedMesh& mesh() const { return prepared_.mesh; }
  const Topology& topology() const { return prepared_.topology; }

  const Surface surface_;
  const Constraints constraints_;
  const FlattenOptions options_;
  const Monitor& monitor_;
  Exec exec_;
  PreparedMesh prepared_;
  Geometry geometry_;
  std::vector<Index> component_;   // of each vertex
  std::vector<Index> outer_loop_;  // per component
  std::vector<Index> loop_of_;     // per vertex, where there are constraints
  std::vector<Feature> features_;  // in the numbers of the ordered mesh
  RestSurface rest_;
  ConstraintView view_;
  std::unique_ptr<ConstraintSystem> system_;
  NodeMap nodes_;
  SymmetricMatrix laplacian_;
  std::vector<Index> order_;
  std::vector<Vec2> rotation_;
  std::optional<GlobalPhase> global_;
  std::unique_ptr<DofMap> first_dof_, dof_;
  std::vector<Vec2> uv_;  // [V] of the ordered mesh
  Flattening result_;
  ConstraintPlan plan_;
};

Result<void> check_options(const FlattenOptions& options) {
  if (!(options.tolerance > 0)) return fail(ErrorCode::BadUsage, "tolerance must be above 0");
  if (options.max_iterations < 0) return fail(ErrorCode::BadUsage, "max_iterations must not be negative");
  if (options.threads < 0) return fail(ErrorCode::BadUsage, "threads must not be negative");
  return {};
}

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
  return with_memory(surface, [&] { return Run(surface, constraints, options, monitor)(); });
}

Result<ConstraintPlan> plan(const Surface& surface, const Constraints& constraints,
                            const FlattenOptions& options, const Monitor& monitor) {
  if (auto checked = check_options(options); !checked) return fail(checked.error());
  return with_memory(surface, [&] { return Run(surface, constraints, options, monitor).plan(); });
}

}  // namespace planish
