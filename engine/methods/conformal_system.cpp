#include "engine/methods/conformal_system.hpp"

#include <algorithm>
#include <numeric>

#include "engine/solve/newton_map.hpp"

namespace planish {

Result<void> ConformalSystem::factor(std::vector<Vec2>& x) {
  dof_.rebase(x);
  const std::vector<std::uint8_t> none_turns(piece_.topology().num_components, 0);
  unknowns_ = whole_unknowns(dof_, piece_.order, piece_.component, none_turns, x);
  if (unknowns_.size == 0) return {};
  std::vector<Index> order(unknowns_.size);
  std::iota(order.begin(), order.end(), 0);
  auto factored = GlobalPhase::factor(exec_, energy_.hessian(unknowns_, diagonal_), order);
  if (!factored) return fail(factored.error());
  global_.emplace(std::move(*factored));
  return {};
}

template <class Visit>
void ConformalSystem::visit_unknowns(In<Vec2> vector, Visit visit) const {
  Index unknown = 0;
  const auto pair = [&](std::size_t at) {
    visit(unknown, vector[at].x, at, false);
    visit(unknown + 1, vector[at].y, at, true);
    unknown += 2;
  };
  for (const Index v : unknowns_.vertex) pair(v);
  for (Index node = dof_.num_vertices(); node < dof_.num_nodes(); ++node) pair(node);
  for (std::size_t at = dof_.num_nodes(); at < vector.size(); ++at) visit(unknown++, vector[at].x, at, false);
}

void ConformalSystem::scatter(In<Vec2> solved, bool second, Out<Vec2> vector) const {
  std::fill(vector.begin(), vector.end(), Vec2{});
  visit_unknowns(vector, [&](Index unknown, double, std::size_t at, bool y) {
    const double value = second ? solved[unknown].y : solved[unknown].x;
    (y ? vector[at].y : vector[at].x) = value;
  });
}

void ConformalSystem::solve(In<Vec2> a, In<Vec2> b, Out<Vec2> a_solution, Out<Vec2> b_solution) const {
  std::vector<Vec2> solved(unknowns_.size);
  visit_unknowns(a, [&](Index unknown, double value, std::size_t, bool) { solved[unknown].x = value; });
  visit_unknowns(b, [&](Index unknown, double value, std::size_t, bool) { solved[unknown].y = value; });
  if (global_) global_->solve(exec_, solved, solved);
  scatter(solved, false, a_solution);
  scatter(solved, true, b_solution);
}

void ConformalSystem::solve(In<Vec2> rhs, Out<Vec2> solution) const {
  std::vector<Vec2> solved(unknowns_.size);
  visit_unknowns(rhs, [&](Index unknown, double value, std::size_t, bool) { solved[unknown].x = value; });
  if (global_) global_->solve(exec_, solved, solved);
  scatter(solved, false, solution);
}

std::vector<Vec2> ConformalSystem::displacement(In<Vec2> change) const {
  std::vector<Vec2> moved(change.begin(), change.end());
  dof_.linearise(moved);
  moved.resize(dof_.num_vertices());
  return moved;
}

}  // namespace planish
