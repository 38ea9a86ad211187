#include "engine/solve/pulled_start.hpp"

#include "engine/solve/boundary_barrier.hpp"
#include "engine/solve/untangle.hpp"

namespace planish {
namespace {

/// Of the pull, against the stiffness of a triangle, which is about 1.
constexpr double kFirstStiffness = 1e-2, kMoreStiffness = 4, kMostStiffness = 1e8;
/// Steps at one stiffness end when the gradient has come down to this.
constexpr double kSettled = 1e-2;
constexpr int kMostStepsEach = 12;

std::vector<Vec2> with_places(In<Vec2> uv, In<VertexPlace> places) {
  std::vector<Vec2> put(uv.begin(), uv.end());
  for (const auto& [v, place] : places) put[v] = place;
  return put;
}

}  // namespace

Result<std::optional<std::vector<Vec2>>> pull_into_place(const Exec& exec, const ArapProblem& problem,
                                                         const MapDensity& density,
                                                         const FindPlaces& find_places,
                                                         const Monitor& monitor, std::vector<Vec2> uv,
                                                         int& steps) {
  NewtonMap map = whole_map(exec, problem, std::move(uv));
  std::vector<VertexPlace> places;
  for (double stiffness = kFirstStiffness; stiffness <= kMostStiffness; stiffness *= kMoreStiffness) {
    auto found = find_places({map.uv().begin(), map.uv().end()});
    if (!found) return fail(found.error());
    places = std::move(found->place);
    map.pull(places, stiffness);
    map.move_to(std::move(found->uv));
    map.lower(density);
    Descent descent(map, kSettled, kMostStepsEach);
    const auto descended = unless_degenerate(take_steps(descent, map, monitor, steps));
    if (!descended) return fail(descended.error());
    std::vector<Vec2> put = with_places(map.uv(), places);
    const bool clear = !problem.barrier || problem.barrier->is_clear_way(map.uv(), put);
    if (clear && map.measure().is_injective(put)) return put;
  }
  return std::optional<std::vector<Vec2>>();
}

}  // namespace planish
