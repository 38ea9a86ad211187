#include "engine/verify/relation_checks.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace planish {
namespace {

constexpr double kDegrees = 180 / kPi;

double angle_error(double angle, double wanted, bool oriented) {
  if (oriented) return std::abs(wrapped(angle - wanted, 360));
  return std::min(std::abs(wrapped(angle - wanted, 180)), std::abs(wrapped(angle + wanted, 180)));
}

/// By its best-fit line or from its first to its last vertex.
std::optional<Vec2> direction_of_feature(EntryCheck& check, const std::string& name, Measure measure) {
  const Evidence& evidence = check.evidence();
  const Feature* feature = check.feature(name);
  if (feature == nullptr) return std::nullopt;
  const int side = check.entry().side;
  const auto chain = measure_chain(*evidence.map, *feature, side, evidence.yielded_by_line(name, side));
  if (!chain) {
    check.fault(chain.error());
    return std::nullopt;
  }
  if (measure == Measure::Line) return fit::line_through(chain->image_of_kept(2)).direction;
  return chain->image.back() - chain->image.front();
}

std::optional<Vec2> direction_of_edge(EntryCheck& check, std::array<Index, 2> edge) {
  const WrittenMap& map = *check.evidence().map;
  const auto [a, b] = edge;
  const Index t = map.triangle_beside(a, b, check.entry().side);
  if (t != kNone) return map.uv(map.corner(t, b)) - map.uv(map.corner(t, a));
  const std::vector<Vec2> start = map.images(a), end = map.images(b);  // features have split the edge
  if (start.size() == 1 && end.size() == 1) return end[0] - start[0];
  check.fault(fmt::format("{}-{} is no edge of the mesh, and its ends have {} and {} uv", a, b, start.size(),
                          end.size()));
  return std::nullopt;
}

/// From the first direction to the second, degrees; none and a fault where one is missing.
std::optional<double> angle_by(EntryCheck& check, std::optional<Measure> measure) {
  const Prescription& asked = check.asked();
  std::vector<Vec2> direction;
  if (asked.type == "direction") direction.push_back({1, 0});
  for (const auto& edge : asked.edges) {
    if (const auto found = direction_of_edge(check, edge)) direction.push_back(*found);
  }
  for (const std::string& name : asked.features) {
    const Measure own = check.evidence().is_line(name) ? Measure::Line : Measure::Chord;
    if (const auto found = direction_of_feature(check, name, measure.value_or(own)))
      direction.push_back(*found);
  }
  if (direction.size() == 2 && norm(direction[0]) > 0 && norm(direction[1]) > 0)
    return kDegrees * argument(multiply(direction[1], conjugate(direction[0])));
  if (check.finding.faults.empty()) check.fault("it has no two directions in the map");
  return std::nullopt;
}

/// A report alone does not say what its angles were measured on: what fits it best.
std::optional<double> likeliest_angle(EntryCheck& check, double stated) {
  std::optional<double> best;
  for (const std::optional<Measure> measure :
       {std::optional<Measure>(), std::optional(Measure::Line), std::optional(Measure::Chord)}) {
    const auto angle = angle_by(check, measure);
    if (!angle) return std::nullopt;
    if (!best || angle_error(*angle, stated, true) < angle_error(*best, stated, true)) best = angle;
  }
  return best;
}

}  // namespace

std::optional<double> check_relation(EntryCheck& check) {
  const Prescription& asked = check.asked();
  if (!check.entry().degrees) {
    check.fault("the report does not state its angle");
    return std::nullopt;
  }
  const double stated = *check.entry().degrees;
  const auto angle = asked.of_file ? angle_by(check, asked.measure) : likeliest_angle(check, stated);
  if (!angle) return std::nullopt;
  if (!(angle_error(*angle, stated, true) <= kDegreesAllowed))
    check.fault(
        fmt::format("its angle in the map is {:.12g} degrees, the report says {:.12g}", *angle, stated));
  if (!asked.degrees) return angle_error(*angle, stated, true);
  // Whether it is oriented is known of the file only.
  return angle_error(*angle, *asked.degrees, asked.oriented);
}

std::optional<double> check_pin(EntryCheck& check) {
  const Prescription& asked = check.asked();
  const WrittenMap& map = *check.evidence().map;
  check.hold(asked.pinned);
  if (asked.pin_uv.empty()) {
    check.finding.unmeasured = "its places are in the constraint file";
    return std::nullopt;
  }
  double far = 0;
  for (std::size_t k = 0; k < asked.pinned.size(); ++k) {
    const std::vector<Vec2> images = map.images(asked.pinned[k]);
    if (images.empty()) check.fault(fmt::format("vertex {} has no place in the map", asked.pinned[k]));
    for (const Vec2 z : images) far = std::max(far, norm(z - asked.pin_uv[k]));
  }
  return far / map.extent();
}

}  // namespace planish
