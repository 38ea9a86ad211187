#include "io/sample_features_json.hpp"

#include <nlohmann/json.hpp>

namespace planish {
namespace {

using Json = nlohmann::ordered_json;

Json feature_json(const SampleFeature& feature) {
  Json points = Json::array();
  for (const Vec3& p : feature.points) points.push_back({p.x, p.y, p.z});
  return {
      {"polyline", std::move(points)}, {"closed", feature.closed}, {"max_distance", feature.max_distance}};
}

/// A constraint speaks of one "feature", a relation of two "features".
Json constraint_json(const SampleConstraint& constraint) {
  Json json{{"type", constraint.type}};
  if (constraint.features.size() == 1) {
    json["feature"] = constraint.features.front();
  } else {
    json["features"] = constraint.features;
  }
  if (constraint.degrees) json["degrees"] = *constraint.degrees;
  return json;
}

}  // namespace

std::string sample_constraints_json(const Sample& sample) {
  std::string text = "{\"version\": 1,\n \"features\": {";
  for (const SampleFeature& feature : sample.features) {
    text += (&feature == &sample.features.front() ? "\n  " : ",\n  ") + Json(feature.name).dump() + ": " +
            feature_json(feature).dump();
  }
  text += "},\n \"constraints\": [";
  for (const SampleConstraint& constraint : sample.constraints) {
    text +=
        (&constraint == &sample.constraints.front() ? "\n  " : ",\n  ") + constraint_json(constraint).dump();
  }
  return text + "]}\n";
}

}  // namespace planish
