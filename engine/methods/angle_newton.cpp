#include "engine/methods/angle_newton.hpp"

#include <algorithm>

#include "engine/methods/angle_border.hpp"
#include "engine/methods/angle_system.hpp"

namespace planish {
namespace {

constexpr double kMet = 1e-12, kAccepted = 1e-9;
/// Steps of the definite matrix before the first one of the Hessian as it is, and how small they are by then.
constexpr int kBeforeExact = 6;
constexpr double kNearEnough = 1e-2;

class AngleNewton {
 public:
  AngleNewton(const Exec& exec, const AngleProblem& problem, std::vector<double> start)
      : exec_(exec),
        problem_(problem),
        rows_(*problem.rows),
        num_corners_(static_cast<Index>(start.size())),
        angle_(std::move(start)),
        step_(angle_.size()),
        multiplier_(rows_.size(), 0),
        price_(rows_.size(), 0),
        long_multiplier_(problem.long_rows->size(), 0),
        long_price_(problem.long_rows->size(), 0),
        system_(exec, problem) {}

  Result<AngleSolution> operator()(double tolerance, int max_steps, const Monitor& monitor) {
    AngleSolution solution;
    double best = kInfinity;
    int wait = kBeforeExact;
    for (int k = 0; k < max_steps; ++k) {
      const bool was_exact = exact_;
      const double before = solution.step;
      exact_ = was_exact || (wait-- <= 0 && before <= kNearEnough);
      if (exact_ && !was_exact) keep();
      auto found = find_step();
      if (!found && (k == 0 || found.error().code != ErrorCode::FactorizationFailed))
        return fail(found.error());
      double share = 0;
      if (found) share = exact_ ? go_whole_way() : advance();
      const bool shrinks = !was_exact || step_size() <= 0.5 * before || step_size() <= tolerance;
      if (exact_ && (share < 1 || !shrinks)) {
        restore();
        wait = kBeforeExact;
        solution.step = kInfinity;
        solution.residual = residual();
        continue;
      }
      solution.step = share > 0 ? step_size() : kInfinity;
      solution.residual = residual();
      solution.energy = energy(angle_) / num_corners_;
      solution.history.push_back(solution.step);
      const Progress progress{
          .phase = Phase::Map, .iteration = k, .energy = solution.energy, .gradient = solution.step};
      if (monitor && monitor(progress) == Verdict::Stop)
        return fail(ErrorCode::Cancelled, "stopped by the caller");
      if (share == 0) break;
      const bool settled = share == 1 && solution.step <= tolerance;
      if (settled &&
          (solution.residual <= kMet || (solution.residual <= kAccepted && solution.residual > 0.5 * best)))
        break;
      if (settled) best = solution.residual;
      if (settled && exact_) {  // what is left is in the rows: the definite matrix rounds less
        exact_ = false;
        wait = max_steps;
      }
    }
    solution.converged = solution.residual <= kAccepted && solution.step <= tolerance;
    solution.angle = std::move(angle_);
    return solution;
  }

 private:
  Result<void> find_step() {
    if (auto factored = system_.factor(angle_, multiplier_, exact_); !factored) return factored;
    if (auto solved = system_.solve(multiplier_, long_multiplier_, step_); !solved) return solved;
    constexpr double kAbove = 1.5;
    for (std::size_t j = 0; j < price_.size(); ++j)
      price_[j] = std::max(price_[j], kAbove * std::abs(multiplier_[j]));
    for (std::size_t k = 0; k < long_price_.size(); ++k)
      long_price_[k] = std::max(long_price_[k], kAbove * std::abs(long_multiplier_[k]));
    return {};
  }

  double energy(In<double> angle) const {
    return exec_.sum_blocks(num_corners_, kBlock, [&](Range r) {
      double sum = 0;
      for (Index c = r.begin; c < r.end; ++c)
        sum += problem_.weight[c] * (angle[c] - problem_.wanted[c]) * (angle[c] - problem_.wanted[c]);
      return sum;
    });
  }

  double triangle_gap(In<double> angle, Index t) const {
    return angle[3 * t] + angle[3 * t + 1] + angle[3 * t + 2] - kPi;
  }

  /// Energy and priced residuals: falls along Newton's direction when prices exceed the multipliers.
  double merit(In<double> angle) const {
    double sum = energy(angle);
    sum += exec_.sum_blocks(rows_.size(), kBlock, [&](Range r) {
      double part = 0;
      for (Index j = r.begin; j < r.end; ++j) part += price_[j] * std::abs(rows_.residual(j, angle));
      return part;
    });
    for (std::size_t k = 0; k < long_price_.size(); ++k) {
      const LongAngleRow& row = (*problem_.long_rows)[k];
      sum += long_price_[k] * std::abs(along(row, angle) - row.target);
    }
    return sum;
  }

  double residual() const {
    std::vector<double> worst(Exec::num_blocks(rows_.size(), kBlock), 0);
    exec_.for_blocks(rows_.size(), kBlock, [&](Index block, Range r) {
      for (Index j = r.begin; j < r.end; ++j)
        worst[block] = std::max(worst[block], std::abs(rows_.residual(j, angle_)));
    });
    double largest = 0;
    for (const double w : worst) largest = std::max(largest, w);
    for (Index t = 0; 3 * t < num_corners_; ++t)
      largest = std::max(largest, std::abs(triangle_gap(angle_, t)));
    for (const LongAngleRow& row : *problem_.long_rows)
      largest = std::max(largest, std::abs(along(row, angle_) - row.target));
    return largest;
  }

  double step_size() const {
    const double sum = exec_.sum_blocks(num_corners_, kBlock, [&](Range r) {
      double part = 0;
      for (Index c = r.begin; c < r.end; ++c) part += step_[c] * step_[c] / (angle_[c] * angle_[c]);
      return part;
    });
    return std::sqrt(sum / num_corners_);
  }

  /// Part of the way to the first angle of 0 that a step may go.
  double longest_share() const {
    constexpr double kShare = 0.9;
    std::vector<double> least(Exec::num_blocks(num_corners_, kBlock), 1);
    exec_.for_blocks(num_corners_, kBlock, [&](Index block, Range r) {
      for (Index c = r.begin; c < r.end; ++c) {
        if (step_[c] < 0) least[block] = std::min(least[block], -kShare * angle_[c] / step_[c]);
        if (step_[c] > 0) least[block] = std::min(least[block], kShare * (kPi - angle_[c]) / step_[c]);
      }
    });
    return *std::min_element(least.begin(), least.end());
  }

  /// Newton's method by itself, near the solution: prices would reject steps that it converges by.
  double go_whole_way() {
    if (longest_share() < 1) return 0;
    for (Index c = 0; c < num_corners_; ++c) angle_[c] += step_[c];
    return 1;
  }
  void keep() {
    kept_angle_ = angle_;
    kept_multiplier_ = multiplier_;
  }
  void restore() {
    exact_ = false;
    angle_ = kept_angle_;
    multiplier_ = kept_multiplier_;
  }

  /// Goes a share of the step, and returns it; 0 where none makes the merit fall.
  double advance() {
    const double before = merit(angle_);
    std::vector<double> trial(angle_.size());
    double share = longest_share();
    constexpr int kHalvings = 25;
    for (int k = 0; k < kHalvings; ++k, share *= 0.5) {
      for (Index c = 0; c < num_corners_; ++c) trial[c] = angle_[c] + share * step_[c];
      const double after = merit(trial);
      if (!(after <= before * (1 + 1e-9) + 1e-12)) continue;
      angle_ = trial;
      return share;
    }
    return 0;
  }

  const Exec& exec_;
  const AngleProblem& problem_;
  const AngleRows& rows_;
  Index num_corners_;
  std::vector<double> angle_, step_;        // [3 T]
  std::vector<double> multiplier_, price_;  // of the rows
  std::vector<double> long_multiplier_, long_price_;
  std::vector<double> kept_angle_, kept_multiplier_;
  bool exact_ = false;  // the Lagrangian's Hessian as it is
  AngleSystem system_;
};

}  // namespace

Result<AngleSolution> solve_angles(const Exec& exec, const AngleProblem& problem, std::vector<double> start,
                                   double tolerance, int max_steps, const Monitor& monitor) {
  return AngleNewton(exec, problem, std::move(start))(tolerance, max_steps, monitor);
}

}  // namespace planish
