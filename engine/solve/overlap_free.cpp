#include "engine/solve/overlap_free.hpp"

#include <numeric>

#include "engine/solve/boundary_barrier.hpp"
#include "engine/solve/convex_start.hpp"
#include "engine/solve/flip_free.hpp"
#include "engine/solve/map_energy.hpp"
#include "engine/solve/straightened_start.hpp"
#include "engine/verify/overlaps.hpp"
#include "engine/verify/simple_boundary.hpp"

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
        corners_(problem.num_components),
        triangles_(problem.num_components) {
    for (Index c = 0; c < static_cast<Index>(problem.energy.corner_vertex.size()); ++c) {
      const Index v = problem.energy.corner_vertex[c], component = problem.vertex_component[v];
      corners_[component].push_back(v);
      if (c % 3 == 0) triangles_[component].push_back(c / 3);
    }
    problem_.barrier = &barrier_;
  }

  Result<void> operator()() {
    OverlapRemoval& removal = minimum_.overlaps;
    removal.pairs_before = pairs(minimum_.uv);
    removal.energy_before = minimum_.history.back().energy;
    if (removal.pairs_before == 0) return {};
    if (!problem_.newton_fits) {
      return fail(
          ErrorCode::OutOfMemory,
          "Newton steps that remove overlaps need more memory than the limit: raise it, or have overlaps "
          "reported alone");
    }
    for (const auto begin : {&OverlapRemover::begin_straightened, &OverlapRemover::begin_first_map,
                             &OverlapRemover::begin_convex, &OverlapRemover::begin_near_constraints}) {
      if (removal.start != OverlapRemoval::Start::None) break;
      if (auto begun = (this->*begin)(); !begun) return begun;
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
    for (const std::size_t k : components_to_search(uv)) sum += find_overlaps(exec_, corners_[k], uv).pairs;
    return sum;
  }
  /// Those that may cover points twice.
  std::vector<std::size_t> components_to_search(In<Vec2> uv) const {
    const auto once = components_covering_once(exec_, problem_.energy.corner_vertex, *problem_.topology, uv);
    std::vector<std::size_t> search;
    for (std::size_t k = 0; k < once.size(); ++k) {
      if (!once[k]) search.push_back(k);
    }
    return search;
  }
  bool is_free(In<Vec2> uv, const DofMap& dof) const {
    return MapEnergy(exec_, problem_.energy).is_injective(uv) && dof.reversed_edges() == 0 && pairs(uv) == 0;
  }

  Result<void> begin_straightened() {
    const auto find = [&](In<Vec2> uv) {
      std::vector<Index> all;
      for (const std::size_t k : components_to_search(uv)) {
        for (const Index t : overlapping_triangles(exec_, corners_[k], uv)) all.push_back(triangles_[k][t]);
      }
      return all;
    };
    auto uv = straighten_boundary(exec_, problem_, density_of(options_), find, monitor_, minimum_.uv,
                                  minimum_.overlaps.newton_steps);
    if (!uv) return fail(uv.error());
    if (!*uv) return {};
    minimum_.uv = std::move(**uv);
    minimum_.overlaps.start = OverlapRemoval::Start::Straightened;
    return {};
  }

  Result<void> begin_first_map() {
    auto first = starts_.first_map();
    if (!first) return fail(first.error());
    if (!is_free(first->uv, *first->dof)) return {};
    minimum_.uv = std::move(first->uv);
    problem_.dof->adopt(*first->dof);
    minimum_.overlaps.start = OverlapRemoval::Start::FirstMap;
    return {};
  }

  /// A convex map is far from any minimum.
  Result<void> begin_convex() {
    if (!starts_.convex_map) return {};
    auto uv = starts_.convex_map().and_then([&](std::vector<Vec2> start) {
      return unfold(exec_, problem_, monitor_, std::move(start), minimum_.overlaps.newton_steps);
    });
    if (!uv) return fail(uv.error());
    if (!is_free(*uv, *problem_.dof)) return {};
    minimum_.uv = std::move(*uv);
    minimum_.overlaps.start = OverlapRemoval::Start::ConvexMap;
    return {};
  }

  /// A map without constraints, features pulled to where constraints want them. Constraints that cannot be met near this map
  /// may well be met elsewhere.
  Result<void> begin_near_constraints() {
    if (!starts_.unconstrained_map) return {};
    auto uv = starts_.unconstrained_map();
    if (!uv) return fail(uv.error());
    if (pairs(*uv) > 0) return {};
    DofMap* dof = nullptr;
    const FindPlaces find_places = [&](std::vector<Vec2> at) -> Result<PulledMap> {
      auto near = starts_.near_constraints(std::move(at));
      if (!near) return fail(near.error());
      dof = near->dof;
      return PulledMap(std::move(*near));
    };
    auto pulled = pull(find_places, std::move(*uv));
    if (!pulled) {
      return pulled.error().code == ErrorCode::ConstraintsConflict ? Result<void>() : fail(pulled.error());
    }
    if (*pulled) begin_at(std::move(**pulled), *dof);
    return {};
  }

  Result<std::optional<std::vector<Vec2>>> pull(const FindPlaces& find_places, std::vector<Vec2> uv) {
    auto near = find_places(std::move(uv));
    if (!near) return fail(near.error());
    NodeMap nodes{.node = std::vector<Index>(near->uv.size()),
                  .fixed = held_elsewhere(near->place),
                  .place = {},
                  .assembly_node = {},
                  .num_nodes = problem_.energy.num_vertices()};
    std::iota(nodes.node.begin(), nodes.node.end(), 0);
    for (std::size_t v = 0; v < nodes.fixed.size(); ++v) {
      if (nodes.fixed[v]) nodes.node[v] = kNone;
    }
    DofMap free(nodes);
    ArapProblem unconstrained = problem_;
    unconstrained.dof = &free;
    unconstrained.energy.fixed = nodes.fixed;
    unconstrained.turns_freely.assign(problem_.num_components, 0);
    return pull_into_place(exec_, unconstrained, density_of(options_), find_places, monitor_,
                           std::move(near->uv), minimum_.overlaps.newton_steps);
  }

  /// Unless it has flips or overlaps. dof: its poses put the features where they lie in uv.
  void begin_at(std::vector<Vec2> uv, DofMap& dof) {
    const std::size_t num_vertices = uv.size();
    uv.resize(dof.size());
    dof.collect(uv);
    if (!dof.expand(uv)) return;
    uv.resize(num_vertices);
    if (!is_free(uv, dof)) return;
    problem_.dof = &dof;
    minimum_.uv = std::move(uv);
    minimum_.overlaps.start = OverlapRemoval::Start::Unconstrained;
  }

  /// [V] the held vertices of components none of whose vertices is pulled.
  std::vector<std::uint8_t> held_elsewhere(In<VertexPlace> places) const {
    std::vector<std::uint8_t> pulled(problem_.num_components, 0);
    for (const auto& [v, place] : places) pulled[problem_.vertex_component[v]] = 1;
    std::vector<std::uint8_t> held(problem_.energy.fixed.begin(), problem_.energy.fixed.end());
    for (std::size_t v = 0; v < held.size(); ++v) held[v] &= !pulled[problem_.vertex_component[v]];
    return held;
  }

  Result<void> descend(const FlattenOptions& options) {
    minimum_.injective = true;
    minimum_.converged = false;
    FlattenOptions from_here = options;
    // From far starts, and boundaries that slide along one another: the lion takes 231 to 514 by the least of differences.
    from_here.max_iterations = minimum_.history.back().iteration + 2 * options.max_iterations;
    return polish(exec_, problem_, from_here, monitor_, minimum_);
  }

  const Exec& exec_;
  ArapProblem problem_;
  const OverlapFreeStarts& starts_;
  const FlattenOptions& options_;
  const Monitor& monitor_;
  Minimum& minimum_;
  BoundaryBarrier barrier_;
  std::vector<std::vector<Index>> corners_,
      triangles_;  // per component: vertices of the corners; which triangles
};

}  // namespace

Result<void> remove_overlaps(const Exec& exec, const ArapProblem& problem, const OverlapFreeStarts& starts,
                             const FlattenOptions& options, const Monitor& monitor, Minimum& minimum) {
  if (!minimum.injective) return {};
  return OverlapRemover(exec, problem, starts, options, monitor, minimum)();
}

}  // namespace planish
