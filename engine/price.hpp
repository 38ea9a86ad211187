// What constraints cost: energies with and without them.
#pragma once

#include "engine/flatten.hpp"
#include "engine/model/price.hpp"

namespace planish {

/// One flattening more than there are constraints, and two.   flattening: that of the whole set, same options
/// Fails: as flatten(), but for sets without one of the constraints.
Result<Price> price(const Surface& surface, const Constraints& constraints, const Flattening& flattening,
                    const FlattenOptions& options = {}, const Monitor& monitor = {});

}  // namespace planish
