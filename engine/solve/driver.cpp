#include "engine/solve/driver.hpp"

#include <algorithm>

#include "engine/solve/quasi_newton.hpp"

namespace planish {
namespace {

/// Energies per area below this are rounding: the gradient is then measured against it.
constexpr double kEnergyFloor = 1e-16;
constexpr double kSufficientDecrease = 1e-4;
constexpr int kMostHalvings = 20;
/// Relative error of an energy sum: steps that change less than this are judged by their slope alone.
constexpr double kEnergyRounding = 1e-14;

class Iteration {
 public:
  Iteration(const Exec& exec, const ArapEnergy& energy, const GlobalPhase& global, int memory)
      : exec_(exec),
        area_(energy.area),
        global_(global),
        local_(exec, energy),
        quasi_newton_(exec, memory),
        uv_(energy.num_vertices()),
        force_(uv_.size()),
        descent_(uv_.size()),
        direction_(uv_.size()) {}

  void start(In<Vec2> rotation) {
    local_.evaluate_rotations(rotation, force_);
    solve();
    uv_ = descent_;
    energy_ = local_.evaluate(uv_, force_);
    solve();
  }

  /// DESIGN 3.5: sqrt(g^T H^-1 g / E) with g = 2 force and H = 2 L.
  double gradient() const {
    const double decrement = std::max(0.0, -2 * dot(exec_, force_, descent_));
    return std::sqrt(decrement / std::max(energy_, kEnergyFloor * area_));
  }

  /// One step along the quasi-Newton direction, or along the plain global step where that one fails to
  /// descend. False where not even that lowers the energy: rounding is reached.
  bool advance() {
    quasi_newton_.direction(force_, descent_, direction_);
    if (descend_along(direction_)) return true;
    quasi_newton_.forget();
    return descend_along(descent_);
  }

  double energy() const { return energy_ / area_; }
  std::vector<Vec2> take_uv() { return std::move(uv_); }

 private:
  void solve() {
    global_.solve(exec_, force_, descent_);
    exec_.for_blocks(static_cast<Index>(descent_.size()), kBlock, [&](Index, Range r) {
      for (Index v = r.begin; v < r.end; ++v) descent_[v] = -descent_[v];
    });
  }

  bool descend_along(In<Vec2> direction) {
    const double slope = 2 * dot(exec_, force_, direction);  // force is half the gradient
    if (!(slope < 0)) return false;
    std::vector<Vec2> trial(uv_.size()), trial_force(uv_.size());
    double length = 1;
    for (int halving = 0; halving < kMostHalvings; ++halving, length *= 0.5) {
      combine(exec_, uv_, {{length, direction}}, trial);
      const double trial_energy = local_.evaluate(trial, trial_force);
      const double wanted = energy_ + kSufficientDecrease * length * slope + kEnergyRounding * energy_;
      if (!(trial_energy <= wanted)) continue;
      accept(std::move(trial), std::move(trial_force), trial_energy);
      return true;
    }
    return false;
  }

  /// Moves to the trial point; what remains of the old one becomes the pair that the quasi-Newton directions
  /// learn.
  void accept(std::vector<Vec2> trial, std::vector<Vec2> trial_force, double trial_energy) {
    uv_.swap(trial);
    force_.swap(trial_force);
    energy_ = trial_energy;
    std::vector<Vec2> solve_change = descent_;
    solve();
    exec_.for_blocks(static_cast<Index>(uv_.size()), kBlock, [&](Index, Range r) {
      for (Index v = r.begin; v < r.end; ++v) {
        trial[v] = uv_[v] - trial[v];
        trial_force[v] = force_[v] - trial_force[v];
        solve_change[v] = solve_change[v] - descent_[v];
      }
    });
    quasi_newton_.add(std::move(trial), std::move(trial_force), std::move(solve_change));
  }

  const Exec& exec_;
  double area_;
  const GlobalPhase& global_;
  LocalPhase local_;
  QuasiNewton quasi_newton_;
  std::vector<Vec2> uv_, force_, descent_, direction_;  // descent_ = -L^-1 force_
  double energy_ = 0;
};

}  // namespace

Result<Minimum> minimise_arap(const Exec& exec, const ArapEnergy& energy, const GlobalPhase& global,
                              In<Vec2> rotation, const FlattenOptions& options, const Monitor& monitor,
                              int memory) {
  Iteration iteration(exec, energy, global, memory);
  iteration.start(rotation);
  Minimum minimum;
  for (int k = 0;; ++k) {
    minimum.gradient = iteration.gradient();
    minimum.history.push_back({k, iteration.energy(), minimum.gradient});
    minimum.converged = minimum.gradient <= options.tolerance;
    if (monitor && monitor({Phase::LocalGlobal, k, iteration.energy(), minimum.gradient}) == Verdict::Stop) {
      return fail(ErrorCode::Cancelled, "stopped by the caller");
    }
    if (minimum.converged || k >= options.max_iterations || !iteration.advance()) break;
  }
  minimum.uv = iteration.take_uv();
  return minimum;
}

}  // namespace planish
