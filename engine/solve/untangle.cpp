#include "engine/solve/untangle.hpp"

#include <algorithm>

namespace planish {
namespace {

// Continuation: epsilon follows the least determinant down.
constexpr double kLeastEpsilon = 1e-9;
constexpr double kSlowestDecrease = 0.1;
/// A map is handed over once its determinants are clearly positive, or grow no more.
constexpr double kClearlyPositive = 1e-3;
constexpr double kSettled = 1e-3;

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

Result<bool> untangle(NewtonMap& map, int most_steps, int& steps,
                      const std::function<Result<void>()>& keep_on) {
  double least = map.measure().least_determinant(map.uv());
  MapDensity density{.kind = MapDensity::Kind::Untangling, .epsilon = first_epsilon(least)};
  for (;; ++steps) {
    const bool positive = least > 0 && map.is_positive();
    if (positive && least > kClearlyPositive) return true;
    if (steps >= most_steps) return positive;
    if (auto go_on = keep_on(); !go_on) return fail(go_on.error());
    map.lower(density);
    const double before = map.energy();
    if (auto prepared = map.prepare(); !prepared) return fail(prepared.error());
    const bool moved = map.advance();
    least = map.measure().least_determinant(map.uv());
    if (positive && (!moved || before - map.energy() < kSettled * before)) return true;
    if (!moved && density.epsilon == kLeastEpsilon) return positive;
    density.epsilon = next_epsilon(density.epsilon, least, before, map.energy());
  }
}

Result<Descent> descend(NewtonMap& map, double tolerance, int most_steps,
                        const std::function<Result<void>(double gradient)>& watch) {
  for (Descent descent;; ++descent.steps) {
    if (auto prepared = map.prepare(); !prepared) return fail(prepared.error());
    descent.gradient = map.gradient();
    if (auto seen = watch(descent.gradient); !seen) return fail(seen.error());
    descent.converged = descent.gradient <= tolerance;
    if (descent.converged || descent.steps >= most_steps || !map.advance()) return descent;
  }
}

}  // namespace planish
