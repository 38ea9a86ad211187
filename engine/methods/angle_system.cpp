#include "engine/methods/angle_system.hpp"

#include "engine/methods/angle_border.hpp"

namespace planish {
namespace {

std::vector<Index> order_of_rows(const AngleProblem& problem) {
  std::vector<Index> order;
  for (const Index v : problem.order) {
    for (Index r = problem.rows->of(v).begin; r < problem.rows->of(v).end; ++r) order.push_back(r);
  }
  return order;
}

}  // namespace

AngleSystem::AngleSystem(const Exec& exec, const AngleProblem& problem)
    : problem_(problem), blocks_(exec, problem), factor_(exec, order_of_rows(problem)) {}

Result<void> AngleSystem::factor(In<double> angle, In<double> multiplier, bool exact) {
  exact_ = exact;
  blocks_.linearise(angle, multiplier, exact);
  return factor_.factor(blocks_.matrix(), exact);
}

Result<void> AngleSystem::solve(Out<double> multiplier, Out<double> long_multiplier, Out<double> step) const {
  std::vector<Vec2> x(blocks_.num_rows());
  blocks_.find_rhs(x);
  auto solved = solve_bordered(blocks_, factor_, *problem_.long_rows, exact_, x, long_multiplier);
  if (!solved) return solved;
  for (std::size_t j = 0; j < x.size(); ++j) multiplier[j] = x[j].x;
  blocks_.find_step(multiplier, long_multiplier, step);
  return {};
}

}  // namespace planish
