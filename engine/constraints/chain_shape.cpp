#include "engine/constraints/chain_shape.hpp"

#include <algorithm>

#include "engine/constraints/cyclic_polygon.hpp"
#include "engine/constraints/fit.hpp"
#include "engine/constraints/geodesic.hpp"
#include "engine/features/feature_error.hpp"

namespace planish {
namespace {

constexpr double kDegree = kPi / 180;
constexpr double kNearlyStraight = 1e-3;  // second singular value over the first
constexpr double kNearlyAcross = 0.2;     // |cosine| between the plane's normal and the surface's

Failure invalid(const ChainInput& input, const std::string& what) {
  return fail(constraint_error(ErrorCode::ConstraintInvalid, *input.set, input.constraint, what));
}

Failure impossible(const ChainInput& input, const std::string& what) {
  return fail(constraint_error(ErrorCode::ConstraintsConflict, *input.set, input.constraint, what));
}

std::string quoted(const ChainInput& input) { return "\"" + input.chain->name + "\""; }

std::vector<Vec3> positions(const ChainInput& input) {
  std::vector<Vec3> position;
  for (const Index v : input.chain->vertex) position.push_back(input.rest->mesh->position[v]);
  return position;
}

void mirror(std::vector<Vec2>& shape) {
  for (Vec2& t : shape) t = conjugate(t);
}

/// The plane of a chain, its normal on the side of the surface's front; says whether the surface tells that side.
struct ChainPlane {
  FittedPlane plane;
  bool undecided = false;
};

ChainPlane plane_of(const ChainInput& input) {
  const std::vector<Vec3> position = positions(input);
  const Vec3 normal = mean_normal(*input.rest, input.chain->vertex, input.chain->closed);
  ChainPlane result{.plane = fit_plane(position)};
  FittedPlane& plane = result.plane;
  if (plane.spread[1] < kNearlyStraight * plane.spread[0]) turn_towards(plane, position, normal);
  const double cosine = dot(plane.normal, normal);
  if (cosine < 0) {
    plane.normal = -1 * plane.normal;
    plane.second = -1 * plane.second;
  }
  result.undecided = std::abs(cosine) < kNearlyAcross;
  return result;
}

/// Turns a closed template the way its chain runs in the plane.
Result<void> orient_closed(const ChainInput& input, Body& body) {
  const auto counter_clockwise = input.chirality->counter_clockwise(body.vertex);
  if (!counter_clockwise)
    return invalid(input, quoted(input) + " is closed, but does not part the surface in two");
  if ((doubled_area(body.shape) > 0) != *counter_clockwise) {
    mirror(body.shape);
    body.mirrored = true;
  }
  return {};
}

void apply_mirror(const std::optional<bool>& wanted, bool undecided, Body& body) {
  body.mirrored = wanted.value_or(false);
  body.chirality_open = undecided && !wanted;
  if (body.mirrored) mirror(body.shape);
}

/// Angle under which a chain's ends are seen along it from the centre of its best-fit circle; negative: it turns right.
double fitted_sweep(In<Vec2> point) {
  const BestCircle circle = best_circle(point);
  double sweep = 0;
  for (std::size_t i = 1; i < point.size(); ++i) {
    const Vec2 a = point[i - 1] - circle.centre, b = point[i] - circle.centre;
    sweep += std::atan2(cross(a, b), dot(a, b));
  }
  return std::isfinite(circle.radius) ? sweep : 0;
}

Result<void> make_arc(const ChainInput& input, const CircleConstraint& rule, In<double> length,
                      double& radius, Body& body) {
  const ChainPlane fitted = plane_of(input);
  std::vector<Vec2> flat;
  for (const Vec3 p : positions(input)) flat.push_back(in_plane(fitted.plane, p));
  const double own_sweep = fitted_sweep(flat);
  const double sweep = rule.sweep_degrees ? *rule.sweep_degrees * kDegree : std::abs(own_sweep);
  constexpr double kLeastSweep = 1e-6;
  const bool straight = !(std::abs(own_sweep) > kLeastSweep);
  if (!(sweep > kLeastSweep)) {
    return invalid(input, quoted(input) +
                              " is straight: its best-fit circle has no radius; give "
                              "sweep_degrees, or ask for a line");
  }
  if (!(sweep < 2 * kPi)) {
    return invalid(input, quoted(input) + " winds " + in_words(sweep / kDegree) +
                              " degrees around its best-fit circle; give sweep_degrees below 360");
  }
  auto arc = cyclic_arc(length, sweep);
  if (!arc) return impossible(input, "the edges of " + quoted(input) + " fit no arc of such a sweep");
  body.shape = std::move(arc->corner);
  if (own_sweep < 0) mirror(body.shape);
  apply_mirror(rule.mirror, fitted.undecided || straight, body);
  body.planarity = fitted.plane.farthest;
  radius = arc->radius;
  return {};
}

Result<void> make_closed_circle(const ChainInput& input, const CircleConstraint& rule, In<double> length,
                                double& radius, Body& body) {
  if (rule.sweep_degrees)
    return invalid(input, "sweep_degrees is for arcs, but " + quoted(input) + " is closed");
  if (rule.mirror) return invalid(input, "mirror is for arcs, but " + quoted(input) + " is closed");
  auto polygon = cyclic_polygon(length);
  if (!polygon)
    return impossible(input, "an edge of " + quoted(input) + " is as long as all its others together");
  body.shape = std::move(polygon->corner);
  body.planarity = plane_of(input).plane.farthest;
  radius = polygon->radius;
  auto oriented = orient_closed(input, body);
  body.mirrored = false;  // a circle has no other way round
  return oriented;
}

}  // namespace

std::vector<double> edge_lengths(const RestSurface& rest, In<Index> chain, bool closed) {
  std::vector<double> length;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < chain.size(); ++i) {
    const Index u = chain[i], v = chain[(i + 1) % chain.size()];
    length.push_back(norm(rest.mesh->position[v] - rest.mesh->position[u]));
  }
  return length;
}

void centre(std::vector<Vec2>& shape) {
  Vec2 sum{};
  for (const Vec2 t : shape) sum += t;
  for (Vec2& t : shape) t = t - (1.0 / static_cast<double>(shape.size())) * sum;
}

Result<void> make_line(const ChainInput& input, const LineConstraint& rule, Body& body) {
  if (body.closed) {
    return impossible(input, quoted(input) +
                                 " is closed, and a closed curve is no straight line; make a "
                                 "feature of a part of it");
  }
  double along = 0;
  body.shape = {Vec2{}};
  for (const double length : edge_lengths(*input.rest, body.vertex, false)) {
    along += length;
    body.shape.push_back({along, 0});
  }
  using Lengths = LineConstraint::Lengths;
  body.kind = rule.lengths == Lengths::Free ? Body::Kind::FreeLine : Body::Kind::Line;
  if (rule.lengths == Lengths::Scale) {
    body.scale = rule.scale.factor;
    body.scale_group = rule.scale.group;
  }
  centre(body.shape);
  return {};
}

Result<void> make_circle(const ChainInput& input, const CircleConstraint& rule, Body& body) {
  body.kind = Body::Kind::Circle;
  if (body.vertex.size() < 3) return invalid(input, quoted(input) + " has fewer than 3 vertices");
  const std::vector<double> length = edge_lengths(*input.rest, body.vertex, body.closed);
  double radius = 0;
  auto made = body.closed ? make_closed_circle(input, rule, length, radius, body)
                          : make_arc(input, rule, length, radius, body);
  if (!made) return made;
  body.scale =
      rule.radius ? std::optional(*rule.radius / input.rest->mesh->unit / radius) : rule.scale.factor;
  body.scale_group = rule.scale.group;
  centre(body.shape);
  return {};
}

Result<void> make_curve(const ChainInput& input, const CurveConstraint& rule, Body& body) {
  body.kind = Body::Kind::Curve;
  body.scale = rule.scale.factor;
  body.scale_group = rule.scale.group;
  if (body.closed && rule.mirror)
    return invalid(input, "mirror is for open curves, but " + quoted(input) + " is closed");
  if (body.closed && body.vertex.size() < 3)
    return invalid(input, quoted(input) + " has fewer than 3 vertices");
  const ChainPlane fitted = plane_of(input);
  body.planarity = fitted.plane.farthest;
  if (rule.shape == CurveConstraint::Shape::Geodesic) {
    std::optional<bool> counter_clockwise;
    if (body.closed) {
      counter_clockwise = input.chirality->counter_clockwise(body.vertex);
      if (!counter_clockwise)
        return invalid(input, quoted(input) + " is closed, but does not part the surface in two");
    }
    auto shape = geodesic_shape(*input.rest, body.vertex, counter_clockwise);
    if (!shape)
      return impossible(input,
                        "the turning of the surface along " + quoted(input) + " does not close in the plane");
    body.shape = std::move(*shape);
    if (!body.closed) apply_mirror(rule.mirror, false, body);
  } else {
    for (const Vec3 p : positions(input)) body.shape.push_back(in_plane(fitted.plane, p));
    if (!body.closed) {
      apply_mirror(rule.mirror, fitted.undecided, body);
    } else if (auto oriented = orient_closed(input, body); !oriented) {
      return oriented;
    }
  }
  centre(body.shape);
  return {};
}

}  // namespace planish
