// Every constraint of a report held against the map, and against the constraint file where there is one.
#pragma once

#include "engine/verify/entry_check.hpp"

namespace planish {

/// An entry of the report each, in its order. `faults` receives what is wrong with the report as a whole: constraints without
/// an entry, entries without a constraint, scales of a group that differ, vertices that nobody holds.
std::vector<ConstraintFinding> check_constraints(const Evidence& evidence, std::vector<std::string>& faults);

}  // namespace planish
