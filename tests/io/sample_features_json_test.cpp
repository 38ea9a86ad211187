#include "io/sample_features_json.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using namespace planish;

TEST_CASE("sample_features_json: names, points, flags and angles read back as they were") {
  Sample sample;
  sample.features = {{"a \"b\"", {{0.1, 1.0 / 3, -2}, {1e-300, 0, 5}}, false, 0.25},
                     {"ring", {{0, 0, 0}}, true, 1}};
  sample.constraints = {{"line", {"ring"}, {}}, {"angle", {"a \"b\"", "ring"}, 62.5}};
  const auto json = nlohmann::json::parse(sample_constraints_json(sample));
  CHECK(json["version"] == 1);
  CHECK(json["features"]["a \"b\""] ==
        nlohmann::json{{"polyline", {{0.1, 1.0 / 3, -2.0}, {1e-300, 0.0, 5.0}}},
                       {"closed", false},
                       {"max_distance", 0.25}});
  CHECK(json["features"]["ring"]["closed"] == true);
  CHECK(json["constraints"][0] == nlohmann::json{{"type", "line"}, {"feature", "ring"}});
  CHECK(json["constraints"][1] ==
        nlohmann::json{{"type", "angle"}, {"features", {"a \"b\"", "ring"}}, {"degrees", 62.5}});
}

TEST_CASE("sample_features_json: a sample without features is a valid constraint file") {
  const auto json = nlohmann::json::parse(sample_constraints_json({}));
  CHECK(json["features"].is_object());
  CHECK(json["constraints"].is_array());
}
