// From one minimum to the next: a guess, made good where it is worst, and from there iterations.
#include <algorithm>

#include "engine/deform/editing.hpp"
#include "engine/solve/quasi_newton.hpp"
#include "engine/solve/relax_around.hpp"

namespace planish {
namespace {

/// A map that follows all but so much of what is held goes on from there; with more left, from a global step.
constexpr double kFollows = 0.1;

/// Vertices that went by such a share of the farthest way are what was moved; were there more, no place would be the worst.
constexpr double kMoved = 0.25;
constexpr std::size_t kMostMoved = 16;
/// Rings of edges to relax, over the way of a vertex in edges: strains fall with the distance over it.
constexpr double kRingsPerWay = 20;
constexpr int kLeastRings = 4, kMostRings = 60;

}  // namespace

Result<Minimum> Editing::follow_held(const SolveOptions& options, const Monitor& monitor) {
  std::vector<Vec2> before = pool_.copy(uv_);
  std::vector<Vec2> way;
  for (const auto& [v, z] : nodes_.place) way.push_back(z - uv_[v]);
  const bool follows = responses_.follow(way, uv_) < kFollows;
  if (follows) {
    for (const auto& [v, z] : nodes_.place) uv_[v] = z;
    auto relaxed = timed(Phase::LocalGlobal, monitor, [&] { return relax_near(way); });
    if (!relaxed) return fail(relaxed.error());
  }
  auto minimum = minimise(flatten_options(options), monitor, Mending::AtEnd, follows);
  if (!minimum || !minimum->injective) return minimum;
  std::vector<Vec2> response = pool_.take(before.size());
  combine(exec_, {{1, minimum->uv}, {-1, before}}, response);
  pool_.give(std::move(before));
  responses_.learn(std::move(way), std::move(response));
  return minimum;
}

/// Around what went farthest.   way: in the order of nodes_.place
Result<void> Editing::relax_near(In<Vec2> way) {
  double most = 0;
  for (const Vec2 w : way) most = std::max(most, norm(w));
  std::vector<Index> moved;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (norm(way[i]) > kMoved * most) moved.push_back(nodes_.place[i].first);
  }
  if (!(most > 0) || moved.size() > kMostMoved) return {};
  DofMap dof(nodes_);
  const ArapProblem arap = problem(*global_, nodes_, dof, {});
  double edges = 0;
  std::size_t count = 0;
  for (const Index v : moved) {
    for (const Index c : slice(arap.energy.star_corner, arap.energy.stars.group(v))) {
      edges += norm(uv_[mesh().corner_vertex[next_corner(c)]] - uv_[v]);
      ++count;
    }
  }
  const double in_edges = most * static_cast<double>(count) / edges;
  const double rings = std::clamp(kRingsPerWay * in_edges, 1.0 * kLeastRings, 1.0 * kMostRings);
  return relax_around(exec_, arap, moved, static_cast<int>(rings), uv_);
}

}  // namespace planish
