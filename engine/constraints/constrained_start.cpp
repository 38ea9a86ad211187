#include "engine/constraints/constrained_start.hpp"

#include <algorithm>

#include "engine/constraints/fit.hpp"

namespace planish {
namespace {

class Starting {
 public:
  Starting(const Exec& exec, const Workpiece& piece, ConstraintSystem& system, GlobalPhase& global,
           const FlattenOptions& options, const Monitor& monitor)
      : exec_(exec), piece_(piece), system_(system), global_(global), options_(options), monitor_(monitor) {}

  Result<ConstrainedStart> operator()() {
    return choose_chirality()
        .and_then([&] { return turn_onto_pins(); })
        .and_then([&] { return map(); })
        .map([&] { return std::move(start_); });
  }

 private:
  Result<void> map() {
    auto first = system_.dof_map(true);
    if (!first) return fail(first.error());
    start_.first = std::move(*first);
    if (!options_.keep_directions && !options_.paper) {
      auto free = system_.dof_map(false);
      if (!free) return fail(free.error());
      start_.free = std::move(*free);
    }
    take_rotations(system_);
    return check_border(start_.last());
  }

  void take_rotations(const ConstraintSystem& system) {
    const In<double> theta = system.theta();
    start_.rotation.resize(theta.size());
    exec_.for_blocks(static_cast<Index>(theta.size()), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) start_.rotation[t] = unit(theta[t]);
    });
  }

  /// The way of lower energy after a few steps.
  Result<void> choose_chirality() {
    for (Index b = 0; b < static_cast<Index>(system_.compiled().bodies.size()); ++b) {
      if (!system_.compiled().bodies[b].chirality_open) continue;
      const Result<double> as_it_is = trial_energy();
      if (!as_it_is && as_it_is.error().code != ErrorCode::ConstraintsConflict) return fail(as_it_is.error());
      auto mirrored = mirror(b);
      const Result<double> other = mirrored ? trial_energy() : fail(mirrored.error());
      if (!other && other.error().code != ErrorCode::ConstraintsConflict) return fail(other.error());
      if (other && (!as_it_is || *other < *as_it_is)) continue;
      if (auto back = mirror(b); !back) return back;
      if (!as_it_is) return fail(as_it_is.error());
    }
    return {};
  }

  Result<void> mirror(Index body) {
    return system_.mirror(body).and_then(
        [&] { return system_.orient(exec_, piece_.start_input(), options_.init); });
  }

  Result<double> trial_energy() {
    constexpr int kTrialSteps = 5;
    if (auto turned = turn_onto_pins(); !turned) return fail(turned.error());
    return few_steps(system_, global_, kTrialSteps).map([](const Minimum& minimum) {
      return minimum.history.back().energy;
    });
  }

  Result<Minimum> few_steps(const ConstraintSystem& system, GlobalPhase& global, int steps) {
    auto dof = system.dof_map(true);
    if (!dof) return fail(dof.error());
    take_rotations(system);
    FlattenOptions few = options_;
    few.max_iterations = steps;
    return minimise_arap(exec_, piece_.problem(global, system.nodes(), **dof, **dof, start_.rotation), few,
                         monitor_);
  }

  /// The first map without pins tells how a component that several of them hold is to be turned.
  Result<void> turn_onto_pins() {
    const Index num_components = piece_.topology().num_components;
    std::vector<Index> pins(num_components, 0);
    for (const Pin& pin : system_.pins()) ++pins[piece_.component[pin.vertex]];
    if (std::none_of(pins.begin(), pins.end(), [](Index n) { return n > 1; })) return {};
    const auto unpinned = system_.without_pins();
    if (!unpinned) return fail(unpinned.error());
    auto global = piece_.factor(exec_, piece_.laplacian_over(exec_, (*unpinned)->nodes()));
    if (!global) return fail(global.error());
    const auto map = few_steps(**unpinned, *global, 0);
    if (!map) return fail(map.error());
    std::vector<double> by(num_components, 0);
    for (Index k = 0; k < num_components; ++k) {
      std::vector<Vec2> from, to;
      for (const Pin& pin : system_.pins()) {
        if (piece_.component[pin.vertex] != k) continue;
        from.push_back(map->uv[pin.vertex]);
        to.push_back(pin.uv);
      }
      if (from.size() > 1) by[k] = argument(best_placement(from, to, 0).c);
    }
    system_.turn(by);
    return {};
  }

  const Exec& exec_;
  const Workpiece& piece_;
  ConstraintSystem& system_;
  GlobalPhase& global_;
  const FlattenOptions& options_;
  const Monitor& monitor_;
  ConstrainedStart start_;
};

}  // namespace

Result<ConstrainedStart> constrained_start(const Exec& exec, const Workpiece& piece, ConstraintSystem& system,
                                           GlobalPhase& global, const FlattenOptions& options,
                                           const Monitor& monitor) {
  return Starting(exec, piece, system, global, options, monitor)();
}

Result<void> check_border(const DofMap& dof) {
  constexpr Index kMostBorderUnknowns = 20'000;
  if (dof.num_border() <= kMostBorderUnknowns) return {};
  return fail(ErrorCode::ConstraintInvalid,
              "constraints leave " + std::to_string(dof.num_border()) +
                  " scales, directions and places along lines free, 20000 are allowed; "
                  "keep or scale the lengths of long lines");
}

}  // namespace planish
