// Limited-memory quasi-Newton directions in the metric of the global phase.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/exec/vector_pool.hpp"

namespace planish {

/// Sum of dot(a[i], b[i]), the same bits on any number of threads.
double dot(const Exec& exec, In<Vec2> a, In<Vec2> b);

/// sum = the scaled vectors added up in their order, in one sweep; sum may not be one of them.
struct Scaled {
  double scale = 0;
  In<Vec2> vector;
};
void combine(const Exec& exec, const std::vector<Scaled>& terms, Out<Vec2> sum);

/// A point of an iteration: where it is, the force f there (half the gradient), and d = -L^-1 f.
struct ForcePoint {
  In<Vec2> position, force, descent;
};

/// L-BFGS whose initial inverse Hessian is the global solve, scaled to the curvature met last: the first direction
/// is a plain local/global step, later ones bend it by what the last steps taught. Needs no solve of its own: with
/// d = -L^-1 f at hand, L^-1 applied to a change y of forces is a change of d's. The changes y themselves are not
/// kept: all that the two loops ask of them are products with the steps s and with L^-1 y, and those are
/// differences of products with the forces before and after. So a step reads every stored vector twice.
/// Ref: Nocedal 1980; the proxy as initial Hessian as in Liu, Bouaziz and Kavan 2017; products kept as in Chen,
/// Wang and Zhou 2014.
class QuasiNewton {
 public:
  /// memory: pairs kept, 0 for plain local/global.   pool: outlives this; pairs are taken from it, and given back
  QuasiNewton(const Exec& exec, int memory, VectorPool& pool) : exec_(exec), memory_(memory), pool_(pool) {}
  ~QuasiNewton() { forget(); }
  QuasiNewton(const QuasiNewton&) = delete;
  QuasiNewton& operator=(const QuasiNewton&) = delete;

  /// Learns from the step between two points; `before` is the one learnt last, if any. A step without positive
  /// curvature s . y teaches nothing.
  void learn(const ForcePoint& before, const ForcePoint& now);

  /// direction [n] out at the point learnt last (any point before the first), whose d is given with f . d.
  /// Returns f . direction.
  double direction(In<Vec2> d, double force_times_d, Out<Vec2> direction) const;

  void forget();

 private:
  struct Pair {
    std::vector<Vec2> step, solved;           // s and L^-1 y
    double step_force = 0, solved_force = 0;  // products of these with the newest force
    std::vector<double> steps_with = {},
                        solved_with = {};  // s_i . y and L^-1 y_i . y of the older pairs i, then its own
    double curvature() const { return steps_with.back(); }
  };

  double solved_product(std::size_t i, std::size_t j) const;
  void drop(std::size_t pair);

  const Exec& exec_;
  int memory_;
  VectorPool& pool_;
  std::vector<Pair> pairs_;  // oldest first
};

}  // namespace planish
