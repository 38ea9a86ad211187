#include "engine/solve/untangle.hpp"

#include <algorithm>

namespace planish {
namespace {

// Continuation: epsilon follows the least determinant down.
constexpr double kLeastEpsilon = 1e-9;
constexpr double kSlowestDecrease = 0.1;
/// Epsilon stays while a step lowers the energy by more than this share.
constexpr double kStillFalling = 0.1;
/// A map is handed over once its determinants are clearly positive, or grow no more.
constexpr double kClearlyPositive = 1e-3;
constexpr double kSettled = 1e-3;

// A factor is kept after steps that go so far and gain so much; and after so many with it while the gradient falls at such a
// rate. A step with it costs a sixth of a factorization where that is what takes the time.
constexpr double kLeastLength = 0.2, kLeastGain = 0.2;
constexpr int kLeastSteps = 15;
constexpr double kSlowestRate = 0.97;

double first_epsilon(double least_determinant) {
  const double below = std::min(0.0, least_determinant);
  return std::sqrt(1e-12 + 0.04 * below * below);
}

double next_epsilon(double epsilon, double least_determinant, double before, double now) {
  const double sigma = std::max(1 - now / before, kSlowestDecrease);
  const double wanted = (1 - sigma) * untangling_chi(least_determinant, epsilon);
  if (least_determinant >= wanted) return kLeastEpsilon;
  return std::max(kLeastEpsilon, 2 * std::sqrt(wanted * (wanted - least_determinant)));
}

}  // namespace

NewtonMap whole_map(const Exec& exec, const ArapProblem& problem, std::vector<Vec2> uv) {
  uv.resize(problem.dof->size());
  problem.dof->collect(uv);
  ReducedUnknowns unknowns =
      whole_unknowns(*problem.dof, problem.order, problem.vertex_component, problem.turns_freely, uv);
  NewtonMap map(exec, problem.energy, std::move(unknowns), problem.dof, std::move(uv));
  map.keep_apart(problem.barrier);
  return map;
}

Untangling::Untangling(NewtonMap& map, int most_steps) : map_(map), most_steps_(most_steps) {
  look();
  density_ = {.kind = MapDensity::Kind::Untangling, .epsilon = first_epsilon(least_)};
}

void Untangling::look() {
  least_ = map_.measure().least_determinant(map_.uv());
  positive_ = least_ > 0 && map_.is_positive();
  done_ = (positive_ && least_ > kClearlyPositive) || steps_ >= most_steps_;
}

Result<void> Untangling::step() {
  map_.lower(density_);
  const double before = map_.energy();
  const bool was_positive = positive_;
  if (auto prepared = map_.prepare(); !prepared) return prepared;
  const bool moved = map_.advance();
  ++steps_;
  look();
  const bool settled = was_positive && positive_ && (!moved || before - map_.energy() < kSettled * before);
  done_ = done_ || settled || (!moved && density_.epsilon == kLeastEpsilon);
  const bool falling = moved && before - map_.energy() > kStillFalling * before;
  if (!falling) density_.epsilon = next_epsilon(density_.epsilon, least_, before, map_.energy());
  return {};
}

/// With the factor at hand, unless the steps with it get nowhere.
bool Descent::prepare_again() {
  if (!serves_) return false;
  map_.prepare_again();
  ++steps_with_;
  return steps_with_ < kLeastSteps ||
         map_.gradient() <= gradient_at_first_ * std::pow(kSlowestRate, steps_with_);
}

Result<void> Descent::prepare() {
  if (prepare_again()) return {};
  serves_ = false;
  if (auto prepared = map_.prepare(); !prepared) return prepared;
  steps_with_ = 0;
  gradient_at_first_ = map_.gradient();
  return {};
}

Result<void> Descent::step() {
  if (auto prepared = prepare(); !prepared) return prepared;
  converged_ = map_.gradient() <= tolerance_;
  if (converged_ || steps_ >= most_steps_) {
    done_ = true;
    return {};
  }
  const bool moved = map_.advance();
  if (steps_with_ == 0) {
    done_ = !moved;
    steps_ += moved;
  }
  serves_ = moved && map_.stride().length >= kLeastLength && map_.stride().gain >= kLeastGain;
  return {};
}

}  // namespace planish
