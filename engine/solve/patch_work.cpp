#include "engine/solve/patch_work.hpp"

#include <algorithm>

#include "engine/solve/untangle.hpp"

namespace planish {
namespace {

constexpr int kRings = 4;
/// Mean stretch below which a triangle is part of a compressed place.
constexpr double kCompressed = 0.6;

}  // namespace

PatchWork::PatchWork(const Exec& exec, const ArapProblem& problem)
    : exec_(exec),
      mesh_(problem.energy),
      measure_(exec, mesh_),
      movable_(mesh_.num_vertices()),
      rank_(mesh_.num_vertices()) {
  const NodeMap& nodes = problem.dof->nodes();
  for (Index v = 0; v < mesh_.num_vertices(); ++v) movable_[v] = nodes.node[v] == v;
  for (Index k = 0; k < static_cast<Index>(problem.order.size()); ++k) rank_[problem.order[k]] = k;
}

/// work(map): steps taken, or an error; positions are written back where it returns true in its second part.
template <class Work>
Result<void> PatchWork::in_patches(const std::vector<Patch>& patches, const Monitor& monitor, Out<Vec2> x,
                                   Work work) {
  std::vector<Result<int>> steps(patches.size(), 0);
  exec_.for_tasks(static_cast<Index>(patches.size()), [&](Index k) {
    const Patch& patch = patches[k];
    const PatchMesh local(mesh_, patch);
    std::vector<Vec2> start;
    for (const Index v : patch.vertex) start.push_back(x[v]);
    NewtonMap map(exec_, local.energy(), local.unknowns(), nullptr, std::move(start));
    int taken = 0;
    const Result<bool> good = work(map, taken);
    steps[k] = taken;
    if (!good && good.error().code != ErrorCode::FactorizationFailed) steps[k] = fail(good.error());
    if (!good || !*good) return;
    for (Index i = 0; i < patch.num_free; ++i) x[patch.vertex[i]] = map.uv()[i];
  });
  int most = 0;
  for (const Result<int>& taken : steps) {
    if (!taken) return fail(taken.error());
    most = std::max(most, *taken);
  }
  steps_ += most;
  if (monitor && monitor({.phase = Phase::Untangle, .iteration = steps_}) == Verdict::Stop)
    return fail(ErrorCode::Cancelled, "stopped by the caller");
  return {};
}

std::vector<Index> PatchWork::faults(In<Vec2> x) const {
  std::vector<Index> triangles = measure_.flipped(x);
  for (const Index v : overwound_vertices(exec_, mesh_, x)) {
    for (const Index c : slice(mesh_.star_corner, mesh_.stars.group(v))) triangles.push_back(c / 3);
  }
  return triangles;
}

std::vector<Index> PatchWork::compressed(In<Vec2> x) const {
  return select(exec_, mesh_.num_triangles(), [&](Index t) {
    const Wirtinger j = wirtinger(corner_weights(mesh_.frame[t]), corner_images(mesh_.corner_vertex, t, x));
    return norm(j.p) < kCompressed;
  });
}

Result<void> PatchWork::untangle(const MapDensity& density, const Monitor& monitor, Out<Vec2> x) {
  constexpr int kMostSteps = 25, kMostDescent = 10;
  constexpr double kNear = 1e-2;
  std::vector<Index> seeds = faults(x);
  const std::vector<Index> around = compressed(x);
  seeds.insert(seeds.end(), around.begin(), around.end());
  const std::vector<Patch> patches = grow_patches(mesh_, seeds, kRings, movable_, rank_);
  return in_patches(patches, monitor, x, [&](NewtonMap& map, int& steps) -> Result<bool> {
    auto positive = planish::untangle(map, kMostSteps, steps, [] { return Result<void>(); });
    if (!positive || !*positive) return positive;
    if (!map.measure().is_injective(map.uv())) return false;
    map.lower(density);
    auto descent = descend(map, kNear, kMostDescent, [](double) { return Result<void>(); });
    if (!descent) return fail(descent.error());
    steps += descent->steps;
    return true;
  });
}

Result<void> PatchWork::relax(const MapDensity& density, double tolerance, const Monitor& monitor,
                              Out<Vec2> x) {
  constexpr int kMostDescent = 200;
  const std::vector<Patch> patches = grow_patches(mesh_, compressed(x), kRings, movable_, rank_);
  return in_patches(patches, monitor, x, [&](NewtonMap& map, int& steps) -> Result<bool> {
    map.lower(density);
    auto descent = descend(map, tolerance, kMostDescent, [](double) { return Result<void>(); });
    if (!descent) return fail(descent.error());
    steps = descent->steps;
    return true;
  });
}

}  // namespace planish
