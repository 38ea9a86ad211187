#include "engine/deform/placed_features.hpp"

#include <cmath>

#include "engine/constraints/map_fit.hpp"
#include "engine/deform/curve_flow.hpp"

namespace planish {
namespace {

Vec2 divide(Vec2 a, Vec2 b) { return (1 / dot(b, b)) * multiply(a, conjugate(b)); }

/// From one similarity's factor to another's, turning and growing evenly.
Vec2 between(Vec2 from, Vec2 to, double share) {
  const Vec2 ratio = divide(to, from);
  return std::pow(norm(ratio), share) * multiply(from, unit(share * argument(ratio)));
}

Vec2 between_points(Vec2 from, Vec2 to, double share) { return (1 - share) * from + share * to; }

/// The mean distance of the owners' vertices from the map, per assembly that pins do not hold.
std::vector<Vec2> mean_shift(const ConstraintSystem& system, const Poses& poses, In<Vec2> uv) {
  const Assemblies& assemblies = system.assemblies();
  std::vector<Vec2> sum(assemblies.size());
  std::vector<Index> count(assemblies.size(), 0);
  for (const Owner& owner : system.owners()) {
    const Index a = assemblies.of[owner.body];
    sum[a] += uv[owner.vertex] - poses.point(owner.body, owner.place);
    ++count[a];
  }
  for (Index a = 0; a < assemblies.size(); ++a)
    sum[a] = assemblies.pinned[a] || count[a] == 0 ? Vec2{} : (1.0 / count[a]) * sum[a];
  return sum;
}

}  // namespace

Result<PlacedFeatures> place_features(const ConstraintSystem& system, In<Vec2> uv) {
  auto poses = system.poses_at(uv);
  if (!poses) return fail(poses.error());
  PlacedFeatures placed{.poses = std::move(*poses), .shift = {}};
  placed.shift = mean_shift(system, *placed.poses, uv);
  return placed;
}

FeatureMotion::FeatureMotion(const ConstraintSystem& system, const PlacedFeatures& placed, In<Vec2> from)
    : system_(system) {
  const std::vector<Body>& bodies = system.compiled().bodies;
  const std::vector<BodyFit> fit = fit_bodies(system.compiled(), from);
  for (Index b = 0; b < static_cast<Index>(bodies.size()); ++b) {
    BodyMotion motion{.centroid = fit[b].centroid,
                      .factor = fit[b].factor,
                      .translation = placed.translation(system.assemblies(), b),
                      .last_factor = placed.poses->factor(b),
                      .from = {},
                      .to = {}};
    const Vec2 origin = placed.poses->translation(b);
    for (Index i = 0; i < static_cast<Index>(bodies[b].vertex.size()); ++i) {
      motion.from.push_back(divide(from[bodies[b].vertex[i]] - motion.centroid, motion.factor));
      motion.to.push_back(divide(placed.poses->point(b, i) - origin, motion.last_factor));
    }
    bodies_.push_back(std::move(motion));
  }
  std::vector<std::uint8_t> listed(from.size(), 0);
  for (const Owner& owner : system.owners()) {
    last_.emplace_back(owner.vertex, placed.point(system.assemblies(), owner));
    listed[owner.vertex] = 1;
  }
  for (const Pin& pin : system.pins()) {
    if (!listed[pin.vertex]) last_.emplace_back(pin.vertex, pin.uv);
  }
  for (const PlacedVertex& v : last_) first_.push_back(from[v.first]);
}

/// In the template's frame: straight lines for all, or the flow placed on them by Procrustes.
std::vector<Vec2> FeatureMotion::shape_at(Index b, double share) const {
  const BodyMotion& motion = bodies_[b];
  const Body& body = system_.compiled().bodies[b];
  std::vector<Vec2> straight;
  for (std::size_t i = 0; i < motion.from.size(); ++i)
    straight.push_back(between_points(motion.from[i], motion.to[i], share));
  const bool flows =
      body.kind == Body::Kind::Line || body.kind == Body::Kind::FreeLine || body.kind == Body::Kind::Circle;
  if (!flows) return straight;
  std::vector<Vec2> curve = flow_curve(motion.from, motion.to, body.closed, share);
  const Placement placement = best_placement(curve, straight, 1);
  for (Vec2& z : curve) z = placement.p + multiply(placement.c, z);
  return curve;
}

std::vector<PlacedVertex> FeatureMotion::at(double share) const {
  std::vector<PlacedVertex> places = last_;
  if (share >= 1) return places;
  std::vector<std::vector<Vec2>> shape;
  for (Index b = 0; b < static_cast<Index>(bodies_.size()); ++b) shape.push_back(shape_at(b, share));
  const std::vector<Owner>& owners = system_.owners();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i >= owners.size()) {  // a pin on no feature
      places[i].second = between_points(first_[i], places[i].second, share);
      continue;
    }
    const BodyMotion& motion = bodies_[owners[i].body];
    places[i].second =
        between_points(motion.centroid, motion.translation, share) +
        multiply(between(motion.factor, motion.last_factor, share), shape[owners[i].body][owners[i].place]);
  }
  return places;
}

}  // namespace planish
