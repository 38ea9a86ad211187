// The "features" of a constraint file, and the names by which the rest of it speaks of them.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/feature.hpp"
#include "io/json_reader.hpp"

namespace planish {

enum class FeatureShape { Curve, Region };

/// The features by name.
class FeatureNames {
 public:
  explicit FeatureNames(const std::vector<FeatureSpec>& features);

  /// The name that a value gives; faults unless it is a feature of that shape.
  std::string resolve(JsonReader& reader, const JsonValue& value, FeatureShape shape) const;

 private:
  std::vector<std::string_view> name_;  ///< in the order of the file
  std::unordered_map<std::string_view, FeatureShape> shape_;
};

/// Reads the object of features; polyline files are relative to `folder`. Faults go to the reader.
std::vector<FeatureSpec> read_features(const Exec& exec, JsonReader& reader, const JsonValue& features,
                                       const std::string& folder);

}  // namespace planish
