// The paper's second method from scratch: a map without constraints, deformed until it meets them.
#pragma once

#include "engine/flatten.hpp"

namespace planish {

/// Flattens without constraints (ARAP, with the options' init, energy, flips, tolerance and iterations), then deforms that map.
/// Fails: as flatten() and deform().   Cost: about that of both.   Ref: Vaitkus and Varady, section 6.
Result<Flattening> flatten_and_deform(const Surface& surface, const Constraints& constraints,
                                      const FlattenOptions& options, const Monitor& monitor);

}  // namespace planish
