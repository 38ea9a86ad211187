// Projected Newton on maps, a step at a time: away from flips, and down to a minimum without them.
#pragma once

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

/// Newton steps down an energy that is infinite at flips, which the map was told to lower, until the gradient is at most the
/// tolerance, no step lowers it, or so many are taken.
class Descent {
 public:
  /// map must outlive it.
  Descent(NewtonMap& map, double tolerance, int most_steps)
      : map_(map), tolerance_(tolerance), most_steps_(most_steps) {}
  bool is_done() const { return done_; }
  bool has_converged() const { return converged_; }
  int steps() const { return steps_; }
  /// Pre: not done.   Fails: as NewtonMap::prepare().
  Result<void> step();

 private:
  NewtonMap& map_;
  double tolerance_;
  int most_steps_, steps_ = 0;
  bool converged_ = false, done_ = false;
};

}  // namespace planish
