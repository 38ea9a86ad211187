// What constraints cost: energies with and without them.
#pragma once

#include "engine/flatten.hpp"
#include "engine/model/price.hpp"

namespace planish {

/// Each from a start of its own, so energies are those of local minima: a cost may come out slightly negative.
///   flattening: that of the whole set, same options
/// Fails: BadUsage without constraints; as flatten(), but for sets without one of the constraints.
/// Cost: a flattening for each constraint, and two.
Result<Price> price(const Surface& surface, const Constraints& constraints, const Flattening& flattening,
                    const FlattenOptions& options = {}, const Monitor& monitor = {});

}  // namespace planish
