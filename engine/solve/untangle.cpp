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

// A factor is kept after steps that go so far and gain so much.
constexpr double kLeastLength = 0.2, kLeastGain = 0.2;
/// Of neighbourhoods, where a step with a kept factor costs a sixth of one with a factor of its own.
constexpr DescentDirections::Patience kLongPatience = {.steps = 15, .slowest_rate = 0.97};

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
bool DescentDirections::prepare_again() {
  if (!serves_) return false;
  map_.prepare_again();
  gradient_.push_back(map_.gradient());
  const auto [steps, rate] = patience_;
  if (gradient_.size() <= steps) return true;
  const double before = gradient_[gradient_.size() - 1 - steps];
  return gradient_.back() <= before * std::pow(rate, steps);
}

Result<void> DescentDirections::factor() {
  if (auto prepared = map_.prepare(); !prepared) return prepared;
  gradient_.assign(1, map_.gradient());
  return {};
}

Result<void> DescentDirections::prepare() { return prepare_again() ? Result<void>() : factor(); }

Result<bool> DescentDirections::advance() {
  bool moved = map_.advance();
  if (!moved && gradient_.size() > 1) {
    if (auto prepared = factor(); !prepared) return fail(prepared.error());
    moved = map_.advance();
  }
  newton_steps_ += moved && gradient_.size() == 1;
  serves_ = moved && map_.stride().length >= kLeastLength && map_.stride().gain >= kLeastGain;
  return moved;
}

Descent::Descent(NewtonMap& map, double tolerance, int most_steps)
    : map_(map), directions_(map, kLongPatience), tolerance_(tolerance), most_steps_(most_steps) {}

Result<void> Descent::step() {
  if (auto prepared = directions_.prepare(); !prepared) return prepared;
  converged_ = map_.gradient() <= tolerance_;
  done_ = converged_ || steps() >= most_steps_;
  if (done_) return {};
  const auto moved = directions_.advance();
  if (!moved) return fail(moved.error());
  done_ = !*moved;
  return {};
}

}  // namespace planish
