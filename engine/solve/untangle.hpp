// Projected Newton on maps, a step at a time: away from flips, and down to a minimum without them.
#pragma once

#include "engine/solve/driver.hpp"
#include "engine/solve/newton_map.hpp"

namespace planish {

/// Minimises the regularised energy while epsilon goes to 0, a Newton step each.   Ref: Garanzha et al. 2021.
class Untangling {
 public:
  /// map must outlive it.
  Untangling(NewtonMap& map, int most_steps);
  bool is_done() const { return done_; }
  /// No triangle is flipped, and lines keep their order.
  bool is_positive() const { return positive_; }
  int steps() const { return steps_; }
  /// Pre: not done.   Fails: as NewtonMap::prepare().
  Result<void> step();

 private:
  void look();
  NewtonMap& map_;
  int most_steps_, steps_ = 0;
  MapDensity density_;
  double least_ = 0;
  bool positive_ = false, done_ = false;
};

/// Ways down an energy that is infinite at flips, which the map was told to lower: Newton's, and quasi-Newton ones with the
/// factor at hand while it serves.
class DescentDirections {
 public:
  /// A kept factor serves while steps go far and gain much, and the gradient falls at a rate a step, on the whole of so many.
  struct Patience {
    std::size_t steps;
    double slowest_rate;
  };
  /// map must outlive it.
  DescentDirections(NewtonMap& map, Patience patience) : map_(map), patience_(patience) {}
  /// Fails: as NewtonMap::prepare().
  Result<void> prepare();
  /// Moves along the direction prepared last, or along Newton's where that one lowers nothing. False, and where it was, where
  /// not even that does.   Fails: as prepare().
  Result<bool> advance();
  int newton_steps() const { return newton_steps_; }

 private:
  Result<void> factor();
  bool prepare_again();
  NewtonMap& map_;
  Patience patience_;
  bool serves_ = false;
  int newton_steps_ = 0;
  std::vector<double> gradient_;  // with this factor, newest last
};

/// Steps along those until the gradient is at most the tolerance, no step lowers the energy, or so many of Newton's are done.
class Descent {
 public:
  /// map must outlive it.
  Descent(NewtonMap& map, double tolerance, int most_steps);
  bool is_done() const { return done_; }
  bool has_converged() const { return converged_; }
  /// Newton steps; those with kept factors in between are not counted.
  int steps() const { return directions_.newton_steps(); }
  /// Pre: not done.   Fails: as NewtonMap::prepare().
  Result<void> step();

 private:
  NewtonMap& map_;
  DescentDirections directions_;
  double tolerance_;
  int most_steps_;
  bool converged_ = false, done_ = false;
};

/// The whole of a problem's map, with its features and its barrier.   uv [V]: features as the DOF map's poses have them
NewtonMap whole_map(const Exec& exec, const ArapProblem& problem, std::vector<Vec2> uv);

/// Where even the projected Hessian is degenerate no step is left, and what was reached stays.
inline Result<void> unless_degenerate(Result<void> done) {
  if (!done && done.error().code == ErrorCode::FactorizationFailed) return {};
  return done;
}

/// Asks whether to go on.   Fails: Cancelled.
inline Result<void> say(const Monitor& monitor, const Progress& progress) {
  if (!monitor || monitor(progress) == Verdict::Continue) return {};
  return fail(ErrorCode::Cancelled, "stopped by the caller");
}

/// Steps of an Untangling or a Descent of the map until it is done; count: in and out, how many of Newton's.
template <class Steps>
Result<void> take_steps(Steps& steps, const NewtonMap& map, const Monitor& monitor, int& count) {
  const int before = count;
  while (!steps.is_done()) {
    auto said = say(monitor, {.phase = Phase::Untangle, .iteration = count, .energy = map.energy()});
    if (auto stepped = said.and_then([&] { return steps.step(); }); !stepped) return stepped;
    count = before + steps.steps();
  }
  return {};
}

}  // namespace planish
