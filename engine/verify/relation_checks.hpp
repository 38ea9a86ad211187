// Residuals of angles and pins (DESIGN 3.8), none where they cannot be had.
#pragma once

#include "engine/verify/entry_check.hpp"

namespace planish {

/// Degrees between what is asked for and the angle from the first direction (or the u axis) to the second.
std::optional<double> check_relation(EntryCheck& check);
/// Distance from the given places over the diagonal of the map; of a vertex with several uv, of the farthest.
std::optional<double> check_pin(EntryCheck& check);

}  // namespace planish
