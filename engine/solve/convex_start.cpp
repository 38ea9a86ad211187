#include "engine/solve/convex_start.hpp"

#include "engine/solve/untangle.hpp"

namespace planish {
namespace {

/// Moves components so that what is held lies at 0.
void hold(const ArapProblem& problem, Out<Vec2> uv) {
  std::vector<Vec2> by(problem.num_components);
  for (Index v = 0; v < static_cast<Index>(uv.size()); ++v) {
    if (problem.energy.fixed[v]) by[problem.vertex_component[v]] = uv[v];
  }
  for (Index v = 0; v < static_cast<Index>(uv.size()); ++v) uv[v] = uv[v] - by[problem.vertex_component[v]];
}

}  // namespace

Result<std::vector<Vec2>> unfold(const Exec& exec, const ArapProblem& problem, const Monitor& monitor,
                                 std::vector<Vec2> uv, int& steps) {
  constexpr int kMostUntangling = 100, kMostDescent = 300;
  constexpr double kNear = 1e-2;
  hold(problem, uv);
  NewtonMap map = whole_map(exec, problem, std::move(uv));
  Untangling untangling(map, kMostUntangling);
  const auto untangled = unless_degenerate(take_steps(untangling, map, monitor, steps));
  if (!untangled) return fail(untangled.error());
  if (untangling.is_positive()) {
    map.lower({.kind = MapDensity::Kind::SymmetricDirichlet});
    Descent descent(map, kNear, kMostDescent);
    const auto descended = unless_degenerate(take_steps(descent, map, monitor, steps));
    if (!descended) return fail(descended.error());
  }
  return std::vector<Vec2>(map.uv().begin(), map.uv().end());
}

}  // namespace planish
