#include "engine/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "kernels/local/jacobians.hpp"
#include "kernels/local/svd2.hpp"

namespace planish {
namespace {

double conformal_of(const Surface& surface, In<Vec2> uv) {
  double sum = 0, whole = 0;
  for (Index t = 0; t < surface.num_triangles(); ++t) {
    const Index* v = &surface.corner_vertex[3 * static_cast<std::size_t>(t)];
    const RestFrame frame =
        rest_frame(surface.position[v[0]], surface.position[v[1]], surface.position[v[2]]);
    const SingularValues s = singular_values(jacobian(frame, uv[v[0]], uv[v[1]], uv[v[2]]));
    const double difference = s.sigma_max - s.sigma_min;
    sum += 0.5 * area(frame) * difference * difference;
    whole += area(frame);
  }
  return sum / whole;
}

/// Errors of the input, not of the method.
bool concerns_all(const Error& error) {
  return exit_code(error.code) != 5 && error.code != ErrorCode::NoConvergence &&
         error.code != ErrorCode::FactorizationFailed && error.code != ErrorCode::ResidualTooLarge &&
         error.code != ErrorCode::OutOfMemory;
}

}  // namespace

double share_of_allowed(const ConstraintOutcome& c) {
  constexpr double kRelative = 1e-9, kDegrees = 1e-7;
  return c.residual / (c.degrees ? kDegrees : kRelative);
}

Result<std::vector<ComparedMethod>> compare(const Surface& surface, const Constraints& constraints,
                                            const std::vector<Contender>& contenders, int threads,
                                            double time_limit, const Monitor& monitor) {
  using Clock = std::chrono::steady_clock;
  std::vector<ComparedMethod> rows;
  ConstraintSet none;
  Constraints without = constraints;
  if (constraints.set) {
    none = *constraints.set;  // the outer loop stays the one that is asked for
    none.constraints.clear();
    without.set = &none;
  }
  for (const Contender& contender : contenders) {
    ComparedMethod row{.contender = contender};
    const auto begin = Clock::now();
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
    bool is_late = false;
    const Monitor limited = [&](const Progress& progress) {
      if (monitor && monitor(progress) == Verdict::Stop) return Verdict::Stop;
      is_late = elapsed() > time_limit;
      return is_late ? Verdict::Stop : Verdict::Continue;
    };
    auto flat = flatten(surface, contender.constrained ? constraints : without,
                        {.method = contender.method, .threads = threads}, limited);
    row.seconds = elapsed();
    if (flat) {
      row.flattening = std::move(*flat);
      row.conformal = conformal_of(surface, row.flattening.uv);
      const std::vector<ConstraintOutcome>& outcome = row.flattening.constraints.outcome;
      const auto worst = std::ranges::max_element(outcome, {}, share_of_allowed);
      if (worst != outcome.end()) row.worst_residual = worst->residual;
    } else if (is_late) {
      row.reason = fmt::format("stopped after {:.1f} of {:g} seconds", row.seconds, time_limit);
    } else if (concerns_all(flat.error())) {
      return fail(flat.error());
    } else {
      row.supported = flat.error().code != ErrorCode::ConstraintUnsupported;
      row.reason = flat.error().what;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace planish
