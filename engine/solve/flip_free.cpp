#include "engine/solve/flip_free.hpp"

#include <algorithm>

#include "engine/solve/convex_start.hpp"
#include "engine/solve/patch_work.hpp"
#include "engine/solve/untangle.hpp"

namespace planish {
namespace {

class FlipRemover {
 public:
  FlipRemover(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
              const Monitor& monitor, Minimum& minimum)
      : exec_(exec),
        problem_(problem),
        options_(options),
        monitor_(monitor),
        minimum_(minimum),
        measure_(exec, problem.energy),
        patches_(exec, problem) {}

  Result<void> operator()() {
    minimum_.removal.flipped_before = static_cast<Offset>(measure_.flipped(minimum_.uv).size());
    minimum_.removal.overwound_before =
        static_cast<Offset>(overwound_vertices(exec_, problem_.energy, minimum_.uv).size());
    minimum_.removal.arap_before = minimum_.history.back().energy;
    if (minimum_.injective) return {};
    least_faults_ = faults(minimum_.uv);
    auto removed = unless_degenerate(from(minimum_.uv));
    if (removed && !minimum_.injective && minimum_.history.size() > 1 && problem_.untangles_first_map)
      removed = unless_degenerate(from_first_map());
    if (removed && !minimum_.injective && problem_.last_resort)
      removed = unless_degenerate(from_last_resort());
    minimum_.removal.patch_steps = patches_.steps_done();
    minimum_.converged = false;
    return removed;
  }

 private:
  Offset faults(In<Vec2> uv) const {
    return static_cast<Offset>(measure_.flipped(uv).size() +
                               overwound_vertices(exec_, problem_.energy, uv).size()) +
           problem_.dof->reversed_edges();
  }

  Result<void> from_first_map() {
    FlattenOptions first = options_;
    first.max_iterations = 0;
    auto map = minimise_arap(exec_, problem_, first, monitor_);
    return map ? from(std::move(map->uv)) : fail(map.error());
  }

  Result<void> from_last_resort() {
    auto uv = problem_.last_resort().and_then([&](std::vector<Vec2> start) {
      return unfold(exec_, problem_, monitor_, std::move(start), minimum_.removal.untangling_steps);
    });
    return uv ? from(std::move(*uv)) : fail(uv.error());
  }

  /// Keeps the result where it has fewer faults.
  Result<void> from(std::vector<Vec2> uv) {
    std::vector<Vec2> mended = uv;
    if (auto done = patches_.untangle(density_of(options_), monitor_, mended); !done) return done;
    if (faults(mended) == 0) {
      uv = std::move(mended);
    } else {
      // From where it was: flips that patches were left with stand between others that are stiff now.
      NewtonMap map = whole_map(exec_, problem_, std::move(uv));
      Untangling untangling(map, problem_.most_untangling_steps);
      if (auto done = take_steps(untangling, map, monitor_, minimum_.removal.untangling_steps); !done)
        return done;
      uv.assign(map.uv().begin(), map.uv().end());
      if (faults(mended) < faults(uv)) uv = std::move(mended);
    }
    const Offset left = faults(uv);
    if (left >= least_faults_) return {};
    least_faults_ = left;
    minimum_.uv = std::move(uv);
    minimum_.injective = left == 0;
    return {};
  }

  const Exec& exec_;
  const ArapProblem& problem_;
  const FlattenOptions& options_;
  const Monitor& monitor_;
  Minimum& minimum_;
  MapEnergy measure_;
  PatchWork patches_;
  Offset least_faults_ = 0;
};

/// Of the whole, whose steps cost a third of a factorization even with a kept factor.
constexpr DescentDirections::Patience kShortPatience = {.steps = 1, .slowest_rate = 0.6};

class Polish {
 public:
  Polish(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options, const Monitor& monitor,
         Minimum& minimum)
      : exec_(exec),
        problem_(problem),
        options_(options),
        monitor_(monitor),
        minimum_(minimum),
        density_(density_of(options)),
        patches_(exec, problem),
        map_(whole_map(exec, problem, minimum.uv)),
        directions_(map_, kShortPatience) {}

  Result<void> operator()() {
    FlipRemoval& removal = minimum_.removal;
    if (options_.energy == Energy::Arap) {
      removal.barrier_weight = density_.barrier.weight;
      removal.barrier_delta = density_.barrier.delta;
    }
    map_.lower(density_);
    patches_help_ = options_.energy == Energy::Arap;  // the other one does not crumple
    while (true) {
      if (patches_help_) {
        if (auto relaxed = relax_patches(); !relaxed) return relaxed;
      }
      if (auto prepared = directions_.prepare(); !prepared) {
        if (auto severe = unless_degenerate(prepared); !severe) return severe;
        break;
      }
      if (auto recorded = record(); !recorded) return recorded;
      const bool last = minimum_.history.back().iteration >= options_.max_iterations;
      minimum_.converged = minimum_.gradient <= options_.tolerance;
      if (minimum_.converged || last) break;
      const auto moved = directions_.advance();
      if (!moved) {
        if (auto severe = unless_degenerate(fail(moved.error())); !severe) return severe;
        break;
      }
      if (!*moved) break;
    }
    removal.newton_steps += directions_.newton_steps();
    removal.energy = map_.energy() / problem_.energy.area;
    removal.patch_steps += patches_.steps_done();
    minimum_.uv.assign(map_.uv().begin(), map_.uv().end());
    return {};
  }

 private:
  /// Clearly below what the whole was left with: else its next step, cut short by the worst patch, does their work. Where the
  /// boundary is kept apart patches hold it, and what moves along it is not theirs to relax: they soon help no more.
  Result<void> relax_patches() {
    constexpr double kLoosest = 1e-4, kShare = 0.01, kShareOfTolerance = 0.1;
    const bool apart = problem_.barrier != nullptr;
    const double close = apart ? kLoosest : std::min(kLoosest, std::max(kShare * left_, options_.tolerance));
    const double tolerance = std::max(close, kShareOfTolerance * options_.tolerance);
    std::vector<Vec2> x = map_.x();
    const double before = map_.energy();
    if (auto done = patches_.relax(density_, tolerance, before, monitor_, x); !done) return done;
    map_.move_to(std::move(x));
    patches_help_ = !apart || map_.energy() < before;
    return {};
  }

  Result<void> record() {
    const int iteration = minimum_.history.back().iteration + 1;
    minimum_.gradient = map_.gradient();
    left_ = minimum_.gradient;
    const Phase phase = problem_.barrier ? Phase::Separate : Phase::Polish;
    minimum_.history.push_back({iteration, map_.energy() / problem_.energy.area, minimum_.gradient, phase});
    const Iterate& now = minimum_.history.back();
    return say(monitor_, {phase, iteration, now.energy, now.gradient});
  }

  const Exec& exec_;
  const ArapProblem& problem_;
  const FlattenOptions& options_;
  const Monitor& monitor_;
  Minimum& minimum_;
  MapDensity density_;
  PatchWork patches_;
  NewtonMap map_;
  DescentDirections directions_;
  bool patches_help_ = false;
  double left_ = kInfinity;  // the gradient at the step before
};

}  // namespace

Result<void> remove_flips(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
                          const Monitor& monitor, Minimum& minimum) {
  return FlipRemover(exec, problem, options, monitor, minimum)();
}

Result<void> polish(const Exec& exec, const ArapProblem& problem, const FlattenOptions& options,
                    const Monitor& monitor, Minimum& minimum) {
  if (!minimum.injective) return {};
  const bool keeps_clear = MapEnergy(exec, problem.energy).least_determinant(minimum.uv) >= Barrier{}.delta;
  if (options.energy == Energy::Arap && minimum.converged && keeps_clear) return {};
  if (minimum.history.back().iteration >= options.max_iterations) return {};
  return Polish(exec, problem, options, monitor, minimum)();
}

}  // namespace planish
