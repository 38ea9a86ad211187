// Maps that an edited map may begin at where parts of it lie on one another.
#include "engine/constraints/constrained_start.hpp"
#include "engine/deform/editing.hpp"
#include "engine/near_constraints.hpp"

namespace planish {

/// Features held: the given map, they in their places; and the given map itself, to pull them there.
OverlapFreeStarts Editing::held_starts(const ArapProblem& arap, const FlattenOptions& options,
                                       const Monitor& monitor) {
  return {.first_map =
              [&] { return before_steps(arap, nullptr, std::make_unique<DofMap>(nodes_), options, monitor); },
          .unconstrained_map = [this] { return aligned_; },
          .near_constraints = [this](std::vector<Vec2> uv) -> Result<OverlapFreeStarts::NearConstraints> {
            separated_dof_ = std::make_unique<DofMap>(nodes_);
            const auto num_constrained = static_cast<std::ptrdiff_t>(nodes_.place.size() - alone_.size());
            return OverlapFreeStarts::NearConstraints{
                {std::move(uv), {nodes_.place.begin(), nodes_.place.begin() + num_constrained}},
                separated_dof_.get()};
          }};
}

/// Features free, from the same two.
OverlapFreeStarts Editing::released_starts(const ArapProblem& arap, const FlattenOptions& options,
                                           const Monitor& monitor) {
  return {.first_map = [&]() -> Result<OverlapFreeStarts::Map> {
            auto poses = system_->poses_at(aligned_);
            if (!poses) return fail(poses.error());
            return before_steps(arap, nullptr, system_->dof_map(std::move(*poses), false), options, monitor);
          },
          .unconstrained_map = [this] { return aligned_; },
          .near_constraints = [this](std::vector<Vec2> uv) { return near_places(*system_, std::move(uv)); }};
}

/// As flatten has them: the map of the first rotations, and that of the surface without constraints.
OverlapFreeStarts Editing::anew_starts(const ArapProblem& arap, const FlattenOptions& options,
                                       const Monitor& monitor) {
  return {.first_map = [&]() -> Result<OverlapFreeStarts::Map> {
            auto first = anew_->dof_map(true), last = anew_->dof_map(false);
            if (!first || !last) return fail(first ? last.error() : first.error());
            return before_steps(arap, first->get(), std::move(*last), options, monitor);
          },
          .unconstrained_map = [&]() -> Result<std::vector<Vec2>> {
            auto flat = planish::flatten(mesh().surface(), options, monitor);
            if (!flat) return fail(flat.error());
            return std::move(flat->uv);
          },
          .near_constraints =
              [this](std::vector<Vec2> uv) {
                near_system_ = std::make_unique<ConstraintSystem>(*anew_);
                return near_places(*near_system_, std::move(uv));
              }};
}

/// The map of the first global step.   first: null: that of the problem
Result<OverlapFreeStarts::Map> Editing::before_steps(ArapProblem arap, DofMap* first,
                                                     std::unique_ptr<DofMap> dof, FlattenOptions options,
                                                     const Monitor& monitor) const {
  if (first != nullptr) arap.first = first;
  arap.dof = dof.get();
  options.max_iterations = 0;
  auto map = minimise_arap(exec_, arap, options, monitor);
  if (!map) return fail(map.error());
  return OverlapFreeStarts::Map{std::move(map->uv), std::move(dof)};
}

Result<OverlapFreeStarts::NearConstraints> Editing::near_places(ConstraintSystem& system,
                                                                std::vector<Vec2> uv) {
  auto near = planish::near_constraints(piece_, system, std::move(uv));
  if (!near) return fail(near.error());
  separated_dof_ = std::move(near->dof);
  return OverlapFreeStarts::NearConstraints{{std::move(near->uv), std::move(near->place)},
                                            separated_dof_.get()};
}

}  // namespace planish
