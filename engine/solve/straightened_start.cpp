#include "engine/solve/straightened_start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/solve/boundary_barrier.hpp"
#include "engine/solve/patch_work.hpp"
#include "engine/solve/untangle.hpp"

namespace planish {
namespace {

constexpr int kFirstRings = 4, kMostRings = 256;
/// Of the map's triangles; neighbourhoods larger than that are not neighbourhoods.
constexpr double kMostShare = 0.1;
constexpr int kMostSteps = 100;
/// Around them, and how close to their minimum neighbourhoods are brought.
constexpr int kSettledRings = 12;
constexpr double kSettled = 1e-3;
/// Half the turning of an arc: two edges of one triangle must not come to lie on one line.
constexpr double kHalfSweep = std::numbers::pi / 8;

/// A point of the arc from a to b that bulges to the right of the way.   share: of its length
Vec2 on_arc(Vec2 a, Vec2 b, double share) {
  const Vec2 chord = b - a;
  const double angle = kHalfSweep * (2 * share - 1), scale = 0.5 / std::sin(kHalfSweep);
  const double along = 0.5 + scale * std::sin(angle),
               beside = scale * (std::cos(angle) - std::cos(kHalfSweep));
  return a + along * chord + beside * Vec2{chord.y, -chord.x};
}

class Straightening {
 public:
  Straightening(const Exec& exec, const ArapProblem& problem, const MapDensity& density,
                const Monitor& monitor)
      : exec_(exec),
        problem_(problem),
        density_(density),
        mesh_(problem.energy),
        monitor_(monitor),
        movable_(mesh_.num_vertices()),
        rank_(mesh_.num_vertices()),
        after_(mesh_.num_vertices(), kNone),
        length_after_(mesh_.num_vertices(), 0),
        before_(mesh_.num_vertices(), kNone) {
    const NodeMap& nodes = problem.dof->nodes();
    for (Index v = 0; v < mesh_.num_vertices(); ++v) movable_[v] = nodes.node[v] == v;
    for (Index k = 0; k < static_cast<Index>(problem.order.size()); ++k) rank_[problem.order[k]] = k;
    for (const Index c : problem.topology->loop_corner) {
      const Index from = mesh_.corner_vertex[c], to = mesh_.corner_vertex[next_corner(c)];
      after_[from] = to;
      before_[to] = from;
      length_after_[from] = norm(edge_vectors(mesh_.frame[c / 3])[c % 3]);
    }
  }

  Result<std::optional<std::vector<Vec2>>> operator()(const FindOverlapping& find, In<Vec2> from,
                                                      int& steps) {
    std::vector<Index> seeds = find(from);
    for (int rings = kFirstRings; rings <= kMostRings; rings *= 2) {
      std::vector<Vec2> uv(from.begin(), from.end());
      const std::vector<Patch> patches = grow_patches(mesh_, seeds, rings, movable_, rank_);
      if (!are_small(patches)) break;
      for (const Patch& patch : patches) {
        auto laid = lay(patch, uv, steps);
        if (!laid) return fail(laid.error());
      }
      const std::vector<Index> left = find(uv);
      if (left.empty()) {
        if (auto settled = settle(seeds, rings, uv, steps); !settled) return fail(settled.error());
        return uv;
      }
      seeds.insert(seeds.end(), left.begin(), left.end());
    }
    return std::optional<std::vector<Vec2>>();
  }

 private:
  bool are_small(const std::vector<Patch>& patches) const {
    double triangles = 0;
    for (const Patch& patch : patches) triangles += static_cast<double>(patch.triangle.size());
    return triangles <= kMostShare * mesh_.num_triangles();
  }

  /// The patch as it was where it cannot be laid without flips.
  Result<void> lay(const Patch& patch, Out<Vec2> uv, int& steps) {
    std::vector<Vec2> placed(uv.begin(), uv.end());
    const Patch held = hold_runs(patch, placed);
    if (held.num_free == 0 || held.num_free == patch.num_free) return {};
    const PatchMesh local(mesh_, held);
    std::vector<Vec2> x;
    for (const Index v : held.vertex) x.push_back(placed[v]);
    NewtonMap map(exec_, local.energy(), local.unknowns(), nullptr, std::move(x));
    Untangling untangling(map, kMostSteps);
    if (auto taken = unless_degenerate(take_steps(untangling, map, monitor_, steps)); !taken) return taken;
    if (!map.measure().is_injective(map.uv())) return {};
    for (std::size_t i = 0; i < held.vertex.size(); ++i) uv[held.vertex[i]] = map.uv()[i];
    return {};
  }

  /// What was laid anew is far from any minimum, and the steps down to one are all near it: the whole, begun from here, would
  /// take as many.
  Result<void> settle(In<Index> seeds, int rings, Out<Vec2> uv, int& steps) {
    Patch patch = grow_patch(mesh_, seeds, rings + kSettledRings, movable_, rank_);
    add_boundary(patch);
    const PatchMesh local(mesh_, patch);
    std::optional<BoundaryBarrier> barrier;
    if (problem_.barrier) barrier.emplace(*problem_.barrier, local.energy(), patch.vertex);
    std::vector<Vec2> x;
    for (const Index v : patch.vertex) x.push_back(uv[v]);
    NewtonMap map(exec_, local.energy(), local.unknowns(), nullptr, std::move(x));
    map.keep_apart(barrier ? &*barrier : nullptr);
    map.lower(density_);
    Descent descent(map, kSettled, kMostSteps);
    if (auto taken = unless_degenerate(take_steps(descent, map, monitor_, steps)); !taken) return taken;
    for (Index i = 0; i < patch.num_free; ++i) uv[patch.vertex[i]] = map.uv()[i];
    return {};
  }

  /// All the boundary that is not in a patch, held: what moves in it must not cross that.
  void add_boundary(Patch& patch) const {
    std::vector<Index> inside = patch.vertex;
    std::sort(inside.begin(), inside.end());
    for (Index v = 0; v < static_cast<Index>(after_.size()); ++v) {
      if (after_[v] != kNone && !std::binary_search(inside.begin(), inside.end(), v))
        patch.vertex.push_back(v);
    }
  }

  /// The runs of the boundary in a patch put on arcs, and held there.
  Patch hold_runs(const Patch& patch, Out<Vec2> uv) const {
    std::vector<Index> free(patch.vertex.begin(), patch.vertex.begin() + patch.num_free);
    std::sort(free.begin(), free.end());
    const auto is_free = [&](Index v) { return std::binary_search(free.begin(), free.end(), v); };
    std::vector<Index> on_run;
    for (const Index v : free) {
      if (after_[v] == kNone || is_free(before_[v])) continue;
      const std::vector<Index> run = run_from(v, is_free);
      put_on_arc(run, uv);
      on_run.insert(on_run.end(), run.begin(), run.end());
    }
    std::sort(on_run.begin(), on_run.end());
    const auto is_on_run = [&](Index v) { return std::binary_search(on_run.begin(), on_run.end(), v); };
    Patch held = patch;
    const auto end_of_free = held.vertex.begin() + held.num_free;
    held.num_free = static_cast<Index>(
        std::stable_partition(held.vertex.begin(), end_of_free, [&](Index v) { return !is_on_run(v); }) -
        held.vertex.begin());
    return held;
  }

  template <class IsFree>
  std::vector<Index> run_from(Index first, IsFree is_free) const {
    std::vector<Index> run;
    for (Index v = first; is_free(v); v = after_[v]) run.push_back(v);
    return run;
  }

  void put_on_arc(In<Index> run, Out<Vec2> uv) const {
    const Vec2 a = uv[before_[run.front()]], b = uv[after_[run.back()]];
    double length = length_after_[before_[run.front()]], so_far = length;
    for (const Index v : run) length += length_after_[v];
    for (const Index v : run) {
      uv[v] = on_arc(a, b, so_far / length);
      so_far += length_after_[v];
    }
  }

  const Exec& exec_;
  const ArapProblem& problem_;
  MapDensity density_;
  const ArapEnergy& mesh_;
  const Monitor& monitor_;
  std::vector<std::uint8_t> movable_;
  std::vector<Index> rank_;
  // Of boundary vertices.
  std::vector<Index> after_;
  std::vector<double> length_after_;
  std::vector<Index> before_;
};

}  // namespace

Result<std::optional<std::vector<Vec2>>> straighten_boundary(const Exec& exec, const ArapProblem& problem,
                                                             const MapDensity& density,
                                                             const FindOverlapping& find,
                                                             const Monitor& monitor, In<Vec2> uv,
                                                             int& steps) {
  return Straightening(exec, problem, density, monitor)(find, uv, steps);
}

}  // namespace planish
