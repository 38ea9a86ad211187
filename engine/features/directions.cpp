#include "engine/features/directions.hpp"

#include <algorithm>

#include "engine/features/feature_error.hpp"

namespace planish {
namespace {

/// A step of a chain along an edge.
struct Use {
  Index low, high;  // ends of the edge
  Index feature;
  bool upwards;
  friend auto operator<=>(const Use&, const Use&) = default;
};

std::vector<Use> uses_of(const std::vector<Feature>& features) {
  std::vector<Use> uses;
  for (std::size_t k = 0; k < features.size(); ++k) {
    for_each_edge(features[k], [&](Index u, Index v) {
      uses.push_back({std::min(u, v), std::max(u, v), static_cast<Index>(k), u < v});
    });
  }
  std::sort(uses.begin(), uses.end());
  return uses;
}

bool on_one_edge(const Use& a, const Use& b) { return a.low == b.low && a.high == b.high; }

/// Edges that a chain shares with others, along with them and against them.
struct Shared {
  Index along = 0, against = 0;
};

Shared shared_edges(const std::vector<Use>& uses, Index feature) {
  Shared shared;
  for (auto first = uses.begin(); first != uses.end();) {
    const auto last = std::find_if(first, uses.end(), [&](const Use& u) { return !on_one_edge(u, *first); });
    const auto own = std::find_if(first, last, [&](const Use& u) { return u.feature == feature; });
    for (auto use = first; use != last && own != last; ++use) {
      if (use->feature != feature) ++(use->upwards == own->upwards ? shared.along : shared.against);
    }
    first = last;
  }
  return shared;
}

}  // namespace

void turn_chains(std::vector<Feature>& features, const std::vector<std::uint8_t>& turnable) {
  for (std::size_t k = 0; k < features.size(); ++k) {
    if (!turnable[k]) continue;
    const Shared shared = shared_edges(uses_of(features), static_cast<Index>(k));
    if (shared.against > 0 && shared.along == 0)
      std::reverse(features[k].vertex.begin(), features[k].vertex.end());
  }
}

Result<void> check_directions(const std::vector<Feature>& features) {
  const std::vector<Use> uses = uses_of(features);
  OffendingIds edges;
  Index feature = kNone, other = kNone;  // of the first fault; the edges are those of this pair
  for (std::size_t i = 1; i < uses.size(); ++i) {
    const Use &a = uses[i - 1], &b = uses[i];
    if (!on_one_edge(a, b) || (a.feature != b.feature && a.upwards == b.upwards)) continue;
    if (feature == kNone) feature = b.feature, other = a.feature;
    if (feature == b.feature && other == a.feature) {
      edges.add(b.upwards ? b.low : b.high, b.upwards ? b.high : b.low);
    }
  }
  if (feature == kNone) return {};
  const std::string& name = features[feature].name;
  const Error error = feature == other
                          ? feature_error(ErrorCode::FeatureBroken, name, "it runs twice along an edge")
                          : feature_error(ErrorCode::FeaturesOverlap, name,
                                          "it runs against feature \"" + features[other].name +
                                              "\" along their common edges");
  return fail(edges.of(error, ElementKind::Edge));
}

}  // namespace planish
