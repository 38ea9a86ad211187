#include "engine/solve/driver.hpp"

#include <algorithm>
#include <initializer_list>

#include "engine/solve/map_energy.hpp"
#include "engine/solve/newton.hpp"
#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

/// Energies per area below this are rounding: the gradient is then measured against it.
constexpr double kEnergyFloor = 1e-14;
constexpr double kSufficientDecrease = 1e-4;
constexpr int kMostHalvings = 20;
/// Relative error of an energy sum: steps that change less than this are judged by their slope alone.
constexpr double kEnergyRounding = 1e-14;

// Newton steps take over when the rate of the last kWatched steps promises more than kPatience further ones.
// A Newton step costs as much as some 50 to 100 others, and a few of them suffice.
constexpr int kWatched = 40;
constexpr double kPatience = 300;
/// Near a minimum far fewer suffice; where flips keep the Hessian from its true form, more would not help
/// either, and the cheap steps go on.
constexpr int kMostNewtonSteps = 12;
/// Above this size the coupled factor takes more memory than the whole rest.
constexpr Index kMostNewtonVertices = 1'000'000;

bool promises_long_way(const std::vector<Iterate>& history, double tolerance) {
  if (history.size() <= 2 * kWatched) return false;
  const double now = history.back().gradient, before = history[history.size() - 1 - kWatched].gradient;
  const double digits_a_step = std::log(before / now) / kWatched;
  return std::log(now / tolerance) > kPatience * digits_a_step;
}

/// A turn of a body by more makes the metric's border stale, radians.
constexpr double kStaleTurn = 0.15;

/// From so many vertices on reading the factor is most of a step, and a rounded one is worth making.
constexpr Index kLeastRounded = 50'000;

/// A map with flips is near enough to the minimum for their removal: what is left is lost in what that changes.
constexpr double kNearEnough = 1e-3;

class Iteration {
 public:
  Iteration(const Exec& exec, const ArapProblem& problem)
      : exec_(exec),
        problem_(problem),
        local_(problem.local ? *problem.local : own_local_.emplace(exec, problem.energy)),
        measure_(exec, problem.energy),
        pool_(problem.pool ? *problem.pool : own_pool_),
        quasi_newton_(exec, kQuasiNewtonMemory, pool_) {}
  ~Iteration() {
    for (std::vector<Vec2>* column :
         {&x_, &force_, &descent_, &direction_, &x_before_, &force_before_, &descent_before_})
      pool_.give(std::move(*column));
  }
  Iteration(const Iteration&) = delete;
  Iteration& operator=(const Iteration&) = delete;

  /// The first global step, for the first rotations; then all directions are free to turn.
  Result<void> start() {
    if (problem_.begins_near) return start_near();
    const bool near = !problem_.near.empty();
    x_ = near ? std::vector<Vec2>(problem_.near.begin(), problem_.near.end()) : problem_.first->origin();
    if (auto used = use(*problem_.first); !used) return used;
    if (!dof_->expand(x_)) return fail(ErrorCode::InternalDefect, "poses leave their joints");
    // A rounded factor needs a second and a third solve to reach the minimiser.
    for (int solve_number = 0; solve_number < (problem_.global->is_rounded() && !near ? 3 : 1);
         ++solve_number) {
      local_.evaluate_rotations(vertices(x_), problem_.rotation, vertices(force_));
      dof_->fold(force_);
      solve();
      combine(exec_, {{1, x_}, {1, descent_}}, x_before_);
      x_.swap(x_before_);
      if (!dof_->expand(x_))
        return fail(ErrorCode::InternalDefect, "the first global step leaves the joints");
    }
    return set_free().and_then([&] { return resume(); });
  }

  Result<void> start_near() {
    x_.assign(problem_.near.begin(), problem_.near.end());
    if (problem_.dof->num_vertices() >= kLeastRounded && !problem_.global->is_rounded())
      problem_.global->round(exec_);
    return use(*problem_.dof).and_then([&] { return resume(); });
  }

  /// From the exact step to the iteration: another DOF map, a metric that is cheaper to solve with.
  Result<void> set_free() {
    const bool round = dof_->num_vertices() >= kLeastRounded && !problem_.global->is_rounded();
    if (round) problem_.global->round(exec_);
    if (problem_.dof != problem_.first) return use(*problem_.dof);
    return round ? refresh() : Result<void>();
  }

  /// Goes on in another DOF map, from the same positions.
  Result<void> use(DofMap& dof) {
    if (dof_) dof.adopt(*dof_);
    dof_ = &dof;
    x_.resize(dof.size());
    dof.rebase(x_);
    make_room({&force_, &descent_, &x_before_});
    return refresh();
  }

  /// Makes the border of the metric that of the present directions.
  Result<void> refresh() {
    const DofMap::Border border =
        dof_->border(problem_.energy.corner_vertex, *problem_.topology, problem_.edge_weight);
    auto bordered = BorderedPhase::factor(exec_, *problem_.global, border.column, border.corner);
    if (!bordered) return fail(bordered.error());
    bordered_.emplace(std::move(*bordered));
    quasi_newton_.forget();
    return {};
  }

  /// The same once bodies have turned far.
  Result<void> keep_fresh() {
    if (dof_->poses() == nullptr || dof_->poses()->turned() <= kStaleTurn) return {};
    dof_->rebase(x_);
    if (auto refreshed = refresh(); !refreshed) return refreshed;
    return resume();
  }

  /// Energy and forces at x_, which is expanded.
  Result<void> resume() {
    if (!dof_->expand(x_)) return fail(ErrorCode::InternalDefect, "poses leave their joints");
    evaluate();
    solve();
    return {};
  }

  /// DESIGN 3.5: sqrt(g^T H^-1 g / E) with g = 2 force and H twice the matrix factored last.
  double gradient() const {
    return std::sqrt(std::max(0.0, -2 * force_times_descent_) /
                     std::max(energy_, kEnergyFloor * problem_.energy.area));
  }

  /// One step along the quasi-Newton direction, or along the plain global step where that one fails to
  /// descend. False where not even that lowers the energy: rounding is reached.
  bool advance() {
    make_room({&direction_, &force_before_, &descent_before_});
    const double slope = quasi_newton_.direction(descent_, force_times_descent_, direction_);
    if (!descend_along(direction_, slope)) {
      quasi_newton_.forget();
      if (!descend_along(descent_, force_times_descent_)) return false;
    }
    descent_.swap(descent_before_);
    solve();
    quasi_newton_.learn({x_before_, force_before_, descent_before_}, {x_, force_, descent_});
    return true;
  }

  /// Makes descent_ the Newton direction at uv_.
  Result<void> prepare_newton() {
    if (!newton_) {
      newton_.emplace(exec_, problem_.energy, problem_.order, problem_.vertex_component,
                      problem_.num_components);
    }
    auto prepared = newton_->direction(x_, force_, descent_);
    force_times_descent_ = dot(exec_, force_, descent_);
    return prepared;
  }

  bool advance_newton() {
    make_room({&force_before_});
    return descend_along(descent_, force_times_descent_);
  }

  /// Back to quasi-Newton steps, from the point where the Newton steps ended.
  void leave_newton() {
    newton_.reset();
    quasi_newton_.forget();
    solve();
  }

  /// Neither flips nor overwound vertices, and lines keep their order.
  bool is_injective() { return measure_.is_injective(vertices(x_)) && dof_->reversed_edges() == 0; }
  /// Back to where the last step began.
  Result<void> take_back() {
    x_.swap(x_before_);
    return resume();
  }

  double energy() const { return energy_ / problem_.energy.area; }
  /// Positions; the DOF map's poses are those of them.
  Result<std::vector<Vec2>> take_uv() {
    if (!dof_->expand(x_)) return fail(ErrorCode::InternalDefect, "poses leave their joints");
    x_.resize(dof_->num_vertices());
    return std::move(x_);
  }

 private:
  /// For those that are needed now: the first solve, with the factor in double, is where memory is short. Entries are all
  /// written before they are read.
  void make_room(std::initializer_list<std::vector<Vec2>*> columns) {
    for (std::vector<Vec2>* column : columns) {
      if (column->empty()) *column = pool_.take(dof_->size());
      column->resize(dof_->size());
    }
  }
  Out<Vec2> vertices(std::vector<Vec2>& x) const { return Out<Vec2>(x).first(dof_->num_vertices()); }

  double evaluate_at(std::vector<Vec2>& x, std::vector<Vec2>& force) {
    const double energy = local_.evaluate(vertices(x), vertices(force));
    dof_->fold(force);
    return energy;
  }
  void evaluate() { energy_ = evaluate_at(x_, force_); }

  void solve() {
    bordered_->solve(exec_, force_, descent_);
    exec_.for_blocks(static_cast<Index>(descent_.size()), kBlock, [&](Index, Range r) {
      for (Index v = r.begin; v < r.end; ++v) descent_[v] = -descent_[v];
    });
    force_times_descent_ = dot(exec_, force_, descent_);
  }

  /// Moves along the direction, whose product with the force is given; the point left goes to *_before_.
  /// False where no length lowers the energy.
  bool descend_along(In<Vec2> direction, double force_times_direction) {
    const double slope = 2 * force_times_direction;  // the force is half the gradient
    if (!(slope < 0)) return false;
    double length = 1;
    for (int halving = 0; halving < kMostHalvings; ++halving, length *= 0.5) {
      combine(exec_, {{1, x_}, {length, direction}}, x_before_);
      if (!dof_->expand(x_before_)) continue;
      const double trial_energy = evaluate_at(x_before_, force_before_);
      const double wanted = energy_ + kSufficientDecrease * length * slope + kEnergyRounding * energy_;
      if (!(trial_energy <= wanted)) continue;
      x_.swap(x_before_);
      force_.swap(force_before_);
      energy_ = trial_energy;
      return true;
    }
    return false;
  }

  const Exec& exec_;
  const ArapProblem& problem_;
  std::optional<LocalPhase> own_local_;
  LocalPhase& local_;
  MapEnergy measure_;
  VectorPool own_pool_;
  VectorPool& pool_;
  QuasiNewton quasi_newton_;
  DofMap* dof_ = nullptr;
  std::optional<BorderedPhase> bordered_;
  std::optional<NewtonDirections> newton_;
  std::vector<Vec2> x_, force_, descent_, direction_;  // descent_ = -H^-1 force_, H the matrix factored last
  // Trial point while searching, then the point left behind.
  std::vector<Vec2> x_before_, force_before_, descent_before_;
  double energy_ = 0, force_times_descent_ = 0;
};

/// The loop around the steps: what is recorded, reported and tested between them.
class Loop {
 public:
  Loop(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options, const Monitor& monitor,
       Watch watch)
      : problem_(problem), options_(options), monitor_(monitor), watch_(watch), iteration_(exec, problem) {}

  Result<Minimum> operator()() {
    if (auto started = iteration_.start(); !started) return fail(started.error());
    if (watch_ == Watch::Injectivity) minimum_.injective = iteration_.is_injective();
    bool newton_may_help = watch_ == Watch::None && !problem_.constrained && problem_.newton_fits &&
                           problem_.energy.num_vertices() <= kMostNewtonVertices;
    while (true) {
      if (auto recorded = record(); !recorded) return fail(recorded.error());
      if (finished()) break;
      if (watch_ == Watch::Injectivity && minimum_.injective && problem_.newton_fits &&
          promises_long_way(minimum_.history, options_.tolerance))
        break;
      if (newton_may_help && promises_long_way(minimum_.history, options_.tolerance)) {
        newton_may_help = false;
        if (auto done = newton(); !done) return fail(done.error());
        if (finished()) break;
        iteration_.leave_newton();
      }
      if (auto fresh = iteration_.keep_fresh(); !fresh) return fail(fresh.error());
      if (!iteration_.advance()) break;
      ++steps_;
      if (watch_ == Watch::None) continue;
      const bool still = iteration_.is_injective();
      if (minimum_.injective && !still) {
        --steps_;
        if (auto back = iteration_.take_back(); !back) return fail(back.error());
        break;
      }
      minimum_.injective = still;
    }
    auto uv = iteration_.take_uv();
    if (!uv) return fail(uv.error());
    minimum_.uv = std::move(*uv);
    return std::move(minimum_);
  }

 private:
  bool finished() const {
    return minimum_.converged || steps_ >= options_.max_iterations ||
           (watch_ == Watch::Injectivity && !minimum_.injective && minimum_.gradient <= kNearEnough);
  }

  Result<void> record() {
    minimum_.gradient = iteration_.gradient();
    minimum_.converged = minimum_.gradient <= options_.tolerance;
    minimum_.history.push_back({steps_, iteration_.energy(), minimum_.gradient});
    const Progress progress{Phase::LocalGlobal, steps_, iteration_.energy(), minimum_.gradient};
    if (monitor_ && monitor_(progress) == Verdict::Stop)
      return fail(ErrorCode::Cancelled, "stopped by the caller");
    return {};
  }

  Result<void> newton() {
    for (int k = 0; k <= kMostNewtonSteps; ++k) {
      auto prepared = iteration_.prepare_newton();
      if (!prepared && prepared.error().code == ErrorCode::FactorizationFailed) {
        iteration_.leave_newton();  // the cheap steps go on
        minimum_.history.pop_back();
        return record();
      }
      if (!prepared) return prepared;
      minimum_.history.pop_back();  // the same point, now measured with the Hessian
      if (auto recorded = record(); !recorded) return recorded;
      if (finished() || k == kMostNewtonSteps || !iteration_.advance_newton()) return {};
      ++steps_;
      minimum_.history.push_back({steps_, iteration_.energy(), 0});
    }
    return {};
  }

  const ArapProblem& problem_;
  const FlattenOptions& options_;
  const Monitor& monitor_;
  Watch watch_;
  Iteration iteration_;
  Minimum minimum_;
  int steps_ = 0;
};

}  // namespace

Result<Minimum> minimise_arap(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
                              const Monitor& monitor, Watch watch) {
  return Loop(exec, problem, options, monitor, watch)();
}

}  // namespace planish
