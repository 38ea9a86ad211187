// Directions of chains that run along common edges.
#pragma once

#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"

namespace planish {

/// Calls body(tail, head) for every edge of a chain.
template <class Body>
void for_each_edge(const Feature& chain, Body body) {
  const std::size_t n = chain.vertex.size();
  for (std::size_t i = 0; i + 1 < n; ++i) body(chain.vertex[i], chain.vertex[i + 1]);
  if (chain.closed && n > 1) body(chain.vertex[n - 1], chain.vertex[0]);
}

/// Turns chains around whose direction nobody chose (a loop, a plane cut, a crease), where all the edges that they
/// share with other chains run against those.   turnable [features]
/// Cost: O(n log n) for n edges.
void turn_chains(std::vector<Feature>& features, const std::vector<std::uint8_t>& turnable);

/// Fails: FeatureBroken (a chain that runs twice along an edge), FeaturesOverlap (two chains that run along an edge
///        in opposite directions); names all common edges of the two.   Cost: O(n log n) for n edges.
Result<void> check_directions(const std::vector<Feature>& features);

}  // namespace planish
