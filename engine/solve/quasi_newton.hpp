// Limited-memory quasi-Newton directions in the metric of the global phase.
#pragma once

#include <utility>
#include <vector>

#include "engine/exec/parallel.hpp"

namespace planish {

/// Dot products of many pairs in one sweep: blocks that several pairs share are read from memory once.
std::vector<double> dots(const Exec& exec, const std::vector<std::pair<In<Vec2>, In<Vec2>>>& pairs);

double dot(const Exec& exec, In<Vec2> a, In<Vec2> b);

/// sum = the scaled vectors added up in their order, in one sweep; sum may not be one of them.
struct Scaled {
  double scale = 0;
  In<Vec2> vector;
};
void combine(const Exec& exec, const std::vector<Scaled>& terms, Out<Vec2> sum);

/// L-BFGS whose initial inverse Hessian is the global solve, scaled to the curvature met last: the first direction
/// is a plain local/global step, later ones bend it by what the last steps taught. Needs no solve of its own: with
/// d = -L^-1 f at hand, L^-1 applied to a difference of forces is a difference of d's. The two loops run on dot
/// products that are kept, so a direction reads every stored vector twice, not once a loop step.
/// Ref: Nocedal 1980; the proxy as initial Hessian as in Liu, Bouaziz and Kavan 2017; products kept as in Chen,
/// Wang and Zhou 2014.
class QuasiNewton {
 public:
  /// memory: pairs kept, 0 for plain local/global.
  QuasiNewton(const Exec& exec, int memory) : exec_(exec), memory_(memory) {}

  /// Learns from a step: change of the position s, of the force y, and of L^-1 y. Pairs without positive
  /// curvature s . y are dropped.
  void add(std::vector<Vec2> step, std::vector<Vec2> force_change, std::vector<Vec2> solved_change);

  /// direction [n] out, from force f [n] and d = -L^-1 f [n].
  void direction(In<Vec2> force, In<Vec2> d, Out<Vec2> direction) const;

  void forget() { pairs_.clear(); }

 private:
  struct Pair {
    std::vector<Vec2> step, force_change, solved_change;
    // Products with the pairs in their order, this one's own last: s . y_j, s_j . y, y . L^-1 y_j. Older
    // pairs only.
    std::vector<double> step_with, with_step, curvature_with;
    double curvature() const { return step_with.back(); }
  };

  double step_times_change(std::size_t i, std::size_t j) const;
  double change_times_solved(std::size_t i, std::size_t j) const;
  void drop_oldest();

  const Exec& exec_;
  int memory_;
  std::vector<Pair> pairs_;  // oldest first
};

}  // namespace planish
