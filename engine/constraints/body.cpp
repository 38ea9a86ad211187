#include "engine/constraints/body.hpp"

#include <algorithm>

namespace planish {

Error constraint_error(ErrorCode code, const ConstraintSet& set, Index constraint, const std::string& what) {
  Error error{.code = code, .what = "constraint \"" + set.constraints[constraint].name + "\": " + what};
  error.place.pointer = "/constraints/" + std::to_string(constraint);
  return error;
}

Error conflict(const ConstraintSet& set, std::vector<Index> constraints, const std::string& what) {
  std::sort(constraints.begin(), constraints.end());
  constraints.erase(std::unique(constraints.begin(), constraints.end()), constraints.end());
  if (constraints.size() == 1)
    return constraint_error(ErrorCode::ConstraintsConflict, set, constraints[0], what);
  constexpr std::size_t kMostNamed = 12;
  std::string names;
  for (std::size_t i = 0; i < std::min(constraints.size(), kMostNamed); ++i) {
    if (i > 0) names += i + 1 == constraints.size() ? " and " : ", ";
    names += "\"" + set.constraints[constraints[i]].name + "\"";
  }
  if (constraints.size() > kMostNamed)
    names += " and " + std::to_string(constraints.size() - kMostNamed) + " more";
  Error error{.code = ErrorCode::ConstraintsConflict,
              .what = "constraints " + names + " cannot all hold: " + what,
              .place = {},
              .element = ElementKind::Constraint,
              .ids = constraints,
              .count = static_cast<Offset>(constraints.size())};
  if (error.ids.size() > kMaxListedIds) error.ids.resize(kMaxListedIds);
  error.place.pointer = "/constraints/" + std::to_string(constraints.front());
  return error;
}

}  // namespace planish
