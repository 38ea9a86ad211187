// The "constraints" of a constraint file.
#pragma once

#include <vector>

#include "engine/model/constraint.hpp"
#include "io/constraints_json_features.hpp"
#include "io/json_reader.hpp"

namespace planish {

/// Reads the array of constraints. Faults go to the reader.
std::vector<Constraint> read_rules(JsonReader& reader, const JsonValue& constraints,
                                   const FeatureNames& names);

}  // namespace planish
