#include "engine/solve/overlap_free.hpp"

#include "engine/solve/boundary_barrier.hpp"
#include "engine/solve/convex_start.hpp"
#include "engine/solve/flip_free.hpp"
#include "engine/solve/map_energy.hpp"
#include "engine/verify/overlaps.hpp"

namespace planish {
namespace {

class OverlapRemover {
 public:
  OverlapRemover(const Exec& exec, const ArapProblem& problem, const OverlapFreeStarts& starts,
                 const FlattenOptions& options, const Monitor& monitor, Minimum& minimum)
      : exec_(exec),
        problem_(problem),
        starts_(starts),
        options_(options),
        monitor_(monitor),
        minimum_(minimum),
        barrier_(exec, problem.energy, *problem.topology, problem.vertex_component),
        corners_(problem.num_components) {
    for (std::size_t c = 0; c < problem.energy.corner_vertex.size(); ++c) {
      const Index v = problem.energy.corner_vertex[c];
      corners_[problem.vertex_component[v]].push_back(v);
    }
    problem_.barrier = &barrier_;
  }

  Result<void> operator()() {
    OverlapRemoval& removal = minimum_.overlaps;
    removal.pairs_before = pairs(minimum_.uv);
    removal.arap_before = minimum_.history.back().energy;
    if (removal.pairs_before == 0) return {};
    auto first = starts_.first_map();
    if (!first) return fail(first.error());
    if (is_free(*first)) {
      minimum_.uv = std::move(*first);
      removal.start = OverlapRemoval::Start::FirstMap;
    } else if (starts_.convex_map) {
      if (auto begun = begin_convex(); !begun) return begun;
    }
    if (removal.start == OverlapRemoval::Start::None) return {};
    const int steps_before = minimum_.removal.newton_steps;
    auto done = descend(options_);
    removal.newton_steps += minimum_.removal.newton_steps - steps_before;
    removal.energy = minimum_.removal.energy;
    return done;
  }

 private:
  Offset pairs(In<Vec2> uv) const {
    Offset sum = 0;
    for (const std::vector<Index>& corners : corners_) sum += find_overlaps(exec_, corners, uv).pairs;
    return sum;
  }
  bool is_free(In<Vec2> uv) const {
    return MapEnergy(exec_, problem_.energy).is_injective(uv) && problem_.dof->reversed_edges() == 0 &&
           pairs(uv) == 0;
  }

  /// A convex map is far from any minimum.
  Result<void> begin_convex() {
    auto uv = starts_.convex_map().and_then([&](std::vector<Vec2> start) {
      return unfold(exec_, problem_, monitor_, std::move(start), minimum_.overlaps.newton_steps);
    });
    if (!uv) return fail(uv.error());
    if (!is_free(*uv)) return {};
    minimum_.uv = std::move(*uv);
    minimum_.overlaps.start = OverlapRemoval::Start::ConvexMap;
    return {};
  }

  Result<void> descend(const FlattenOptions& options) {
    minimum_.injective = true;
    minimum_.converged = false;
    FlattenOptions from_here = options;
    from_here.max_iterations += minimum_.history.back().iteration;
    return polish(exec_, problem_, from_here, monitor_, minimum_);
  }

  const Exec& exec_;
  ArapProblem problem_;
  const OverlapFreeStarts& starts_;
  const FlattenOptions& options_;
  const Monitor& monitor_;
  Minimum& minimum_;
  BoundaryBarrier barrier_;
  std::vector<std::vector<Index>> corners_;  // vertices of the triangles, per component
};

}  // namespace

Result<void> remove_overlaps(const Exec& exec, const ArapProblem& problem, const OverlapFreeStarts& starts,
                             const FlattenOptions& options, const Monitor& monitor, Minimum& minimum) {
  if (!minimum.injective) return {};
  return OverlapRemover(exec, problem, starts, options, monitor, minimum)();
}

}  // namespace planish
