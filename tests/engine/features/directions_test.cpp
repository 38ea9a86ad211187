#include "engine/features/directions.hpp"

#include <doctest/doctest.h>

using namespace planish;

namespace {

Feature chain(std::string name, std::vector<Index> vertex, bool closed = false) {
  Feature feature;
  feature.name = std::move(name);
  feature.vertex = std::move(vertex);
  feature.closed = closed;
  return feature;
}

}  // namespace

TEST_CASE("directions: chains along one another are accepted, against one another refused with the edges") {
  CHECK(check_directions({chain("a", {1, 2, 3}), chain("b", {2, 3, 4})}));
  const auto refused = check_directions({chain("a", {1, 2, 3, 4}), chain("b", {4, 3, 2})});
  REQUIRE(!refused);
  CHECK(refused.error().code == ErrorCode::FeaturesOverlap);
  CHECK(refused.error().ids == std::vector<Index>{3, 2, 4, 3});
}

TEST_CASE("directions: a chain twice along an edge is refused, also where another one has that edge") {
  const Feature square = chain("square", {0, 1, 2, 3}, true);
  for (const bool beside : {false, true}) {
    std::vector<Feature> features = {chain("twice", {0, 1, 2, 3, 0, 1})};
    if (beside) features.insert(features.begin(), square);
    const auto refused = check_directions(features);
    REQUIRE(!refused);
    CHECK(refused.error().code == ErrorCode::FeatureBroken);
  }
}

TEST_CASE("directions: a chain without a direction of its own turns with the others, unless they disagree") {
  std::vector<Feature> features = {chain("drawn", {5, 6, 7}), chain("cut", {9, 7, 6, 5, 4})};
  turn_chains(features, {0, 1});
  CHECK(features[1].vertex == std::vector<Index>{4, 5, 6, 7, 9});
  features = {chain("drawn", {5, 6, 7}), chain("other", {9, 8}), chain("loop", {4, 5, 6, 7, 8, 9}, true)};
  turn_chains(features, {0, 0, 1});
  CHECK(features[2].vertex.front() == 4);  // along the one, against the other
  CHECK(!check_directions(features));
}
