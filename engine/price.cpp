#include "engine/price.hpp"

#include <algorithm>

namespace planish {

Result<Price> price(const Surface& surface, const Constraints& constraints, const Flattening& flattening,
                    const FlattenOptions& options, const Monitor& monitor) {
  if (constraints.set == nullptr)
    return fail(ErrorCode::BadUsage, "there are no constraints to state prices of");
  Price result{.energy = flattening.certificate.arap};
  const auto unconstrained = flatten(surface, options, monitor);
  if (!unconstrained) return fail(unconstrained.error());
  result.unconstrained = unconstrained->certificate.arap;
  FlattenOptions keeping = options;
  keeping.keep_directions = true;
  const auto kept = flatten(surface, constraints, keeping, monitor);
  if (!kept) return fail(kept.error());
  result.without_refit = kept->certificate.arap;
  for (std::size_t k = 0; k < constraints.set->constraints.size(); ++k) {
    ConstraintSet others = *constraints.set;
    others.constraints.erase(others.constraints.begin() + static_cast<std::ptrdiff_t>(k));
    Constraints without = constraints;
    without.set = &others;
    ConstraintPrice item{.name = constraints.set->constraints[k].name};
    const auto flat = flatten(surface, without, options, monitor);
    if (flat) {
      item.energy_without = flat->certificate.arap;
      item.cost = result.energy - item.energy_without;
    } else if (flat.error().code == ErrorCode::Cancelled) {
      return fail(flat.error());
    } else {
      item.reason = flat.error().what;
    }
    result.constraints.push_back(std::move(item));
  }
  return result;
}

}  // namespace planish
