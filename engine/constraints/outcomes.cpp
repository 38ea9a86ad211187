// Residuals of DESIGN 3.8, measured on coordinates.
#include <algorithm>

#include "engine/constraints/chain_shape.hpp"
#include "engine/constraints/fit.hpp"
#include "engine/constraints/system.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {
namespace {

constexpr double kDegrees = 180 / kPi;

/// The vertices of a body that it did not yield: their images and template points.
struct Kept {
  std::vector<Vec2> image, shape;
};

Kept kept(const Body& body, In<std::uint8_t> yielded, In<Vec2> uv) {
  Kept result;
  for (std::size_t i = 0; i < body.vertex.size(); ++i) {
    if (yielded[i]) continue;
    result.image.push_back(uv[body.vertex[i]]);
    result.shape.push_back(body.shape[i]);
  }
  return result;
}

double distance_from_line(const Kept& points) {
  if (points.image.size() < 3) return 0;
  const BestLine line = best_line(points.image);
  double farthest = 0;
  for (const Vec2 z : points.image)
    farthest = std::max(farthest, std::abs(cross(line.direction, z - line.mean)));
  return farthest;
}

double distance_from_shape(const Kept& points, double unit, double scale) {
  if (points.image.empty()) return 0;
  std::vector<Vec2> shape = points.shape;
  for (Vec2& t : shape) t = unit * t;
  const Placement placement = best_placement(shape, points.image, scale);
  double farthest = 0;
  for (std::size_t i = 0; i < shape.size(); ++i)
    farthest = std::max(farthest, norm(placement.p + multiply(placement.c, shape[i]) - points.image[i]));
  return farthest;
}

double distance_from_circle(const Kept& points) {
  if (points.image.size() < 4) return 0;
  const BestCircle circle = best_circle(points.image);
  if (!std::isfinite(circle.radius)) return 0;  // a flat arc is judged by its template
  double farthest = 0;
  for (const Vec2 z : points.image)
    farthest = std::max(farthest, std::abs(norm(z - circle.centre) - circle.radius));
  return farthest / circle.radius;
}

bool runs_forwards(const Body& body, In<Vec2> uv) {
  const Vec2 whole = uv[body.vertex.back()] - uv[body.vertex.front()];
  for (std::size_t i = 1; i < body.vertex.size(); ++i) {
    if (!(dot(uv[body.vertex[i]] - uv[body.vertex[i - 1]], whole) > 0)) return false;
  }
  return true;
}

}  // namespace

ConstraintOutcome ConstraintSystem::begin_outcome(Index constraint) const {
  const Constraint& c = view_.set->constraints[constraint];
  ConstraintOutcome outcome{.name = c.name, .type = c.type};
  std::visit(
      [&](const auto& rule) {
        using Rule = std::decay_t<decltype(rule)>;
        if constexpr (std::is_same_v<Rule, AngleConstraint>) {
          outcome.features = rule.features;
          outcome.edges = rule.edges;
        } else if constexpr (std::is_same_v<Rule, PinConstraint>) {
          outcome.pinned = rule.vertex;
        } else {
          if (!rule.feature.empty()) outcome.features = {rule.feature};
          if constexpr (std::is_same_v<Rule, DirectionConstraint>) {
            if (rule.edge) outcome.edges = {*rule.edge};
          }
        }
      },
      c.rule);
  return outcome;
}

ConstraintOutcome ConstraintSystem::outcome_of_body(const Body& body, Index number, In<Vec2> uv) const {
  const double unit = rest_.mesh->unit, size = unit * body.size;
  ConstraintOutcome outcome = begin_outcome(body.constraint);
  outcome.side = view_.features[body.feature].side;
  const std::vector<std::uint8_t>& yielded = agreement_.yielded[number];
  const Kept points = kept(body, yielded, uv);
  const double scale = body.scale.value_or(0);
  switch (body.kind) {
    case Body::Kind::Line:
      outcome.residual_abs = std::max(distance_from_line(points), distance_from_shape(points, unit, scale));
      break;
    case Body::Kind::FreeLine: outcome.residual_abs = distance_from_line(points); break;
    default: outcome.residual_abs = distance_from_shape(points, unit, scale); break;
  }
  outcome.residual = outcome.residual_abs / size;
  if (body.kind == Body::Kind::Circle)
    outcome.residual = std::max(outcome.residual, distance_from_circle(points));
  if (body.is_straight()) outcome.keeps_order = runs_forwards(body, uv);
  std::vector<Vec2> shape = body.shape;
  for (Vec2& t : shape) t = unit * t;
  if (body.kind == Body::Kind::FreeLine) {
    outcome.orientation = kDegrees * argument(uv[body.vertex.back()] - uv[body.vertex.front()]);
  } else {
    // Where all vertices were yielded they tell where the template lies as well as they can.
    const std::vector<std::uint8_t> none(yielded.size(), 0);
    const Kept placed = points.image.size() > 1 ? points : kept(body, none, uv);
    std::vector<Vec2> from = placed.shape;
    for (Vec2& t : from) t = unit * t;
    const Placement placement = best_placement(from, placed.image, scale);
    outcome.scale = norm(placement.c);
    outcome.orientation = kDegrees * argument(placement.c);
  }
  if (body.kind != Body::Kind::FreeLine) outcome.shape = std::move(shape);
  outcome.mirrored = body.mirrored;
  outcome.chirality_open = body.chirality_open;
  if (body.kind == Body::Kind::Curve || body.kind == Body::Kind::Circle)
    outcome.planarity = unit * body.planarity;
  if (body.kind == Body::Kind::Region) outcome.planarity = body.planarity;
  outcome.mismatch = unit * agreement_.mismatch[number];
  if (outcome.mismatch > 0) {
    if (const Index to = agreement_.mismatch_with[number]; to != kNone)
      outcome.yielded_to = view_.set->constraints[to].name;
    for (std::size_t i = 0; i < yielded.size(); ++i) {
      if (yielded[i]) outcome.yielded.push_back(rest_.mesh->vertex_origin[body.vertex[i]]);
    }
  }
  return outcome;
}

/// What a relation measures of a body: the direction of its best-fit line, or its chord.
Vec2 ConstraintSystem::measured_vector(Index b, In<Vec2> uv) const {
  const Body& body = compiled_.bodies[b];
  const Vec2 chord = uv[body.vertex.back()] - uv[body.vertex.front()];
  if (!body.is_straight()) return chord;
  const Kept points = kept(body, agreement_.yielded[b], uv);
  if (points.image.size() < 2) return chord;
  const Vec2 along = best_line(points.image).direction;
  return dot(along, chord) < 0 ? -along : along;
}

ConstraintOutcome ConstraintSystem::outcome_of_relation(std::size_t number, In<Vec2> uv) const {
  const Relation& relation = compiled_.relations[number];
  ConstraintOutcome outcome = begin_outcome(relation.constraint);
  const Vec2 a = relation.a == kNone ? Vec2{1, 0} : measured_vector(relation.a, uv);
  const Vec2 b = measured_vector(relation.b, uv);
  const double angle = argument(multiply(b, conjugate(a)));
  outcome.side = relation.side;
  outcome.degrees = kDegrees * angle;
  outcome.residual = outcome.residual_abs =
      kDegrees * std::abs(reduce_angle(angle - orientation_.chosen[number]));
  return outcome;
}

ConstraintOutcome ConstraintSystem::outcome_of_pins(Index constraint, In<Vec2> uv) const {
  ConstraintOutcome outcome = begin_outcome(constraint);
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  for (const Vec2 z : uv) {
    lower = {std::min(lower.x, z.x), std::min(lower.y, z.y)};
    upper = {std::max(upper.x, z.x), std::max(upper.y, z.y)};
  }
  for (const Pin& pin : compiled_.pins) {
    if (pin.constraint != constraint) continue;
    outcome.residual_abs = std::max(outcome.residual_abs, norm(uv[pin.vertex] - rest_.mesh->unit * pin.uv));
  }
  outcome.residual = outcome.residual_abs / norm(upper - lower);
  return outcome;
}

std::vector<ConstraintOutcome> ConstraintSystem::outcomes(In<Vec2> uv) const {
  std::vector<std::vector<ConstraintOutcome>> of(view_.set->constraints.size());
  for (Index b = 0; b < static_cast<Index>(compiled_.bodies.size()); ++b) {
    const Body& body = compiled_.bodies[b];
    if (body.kind != Body::Kind::Chord) of[body.constraint].push_back(outcome_of_body(body, b, uv));
  }
  for (std::size_t k = 0; k < compiled_.relations.size(); ++k)
    of[compiled_.relations[k].constraint].push_back(outcome_of_relation(k, uv));
  std::vector<ConstraintOutcome> all;
  for (Index c = 0; c < static_cast<Index>(of.size()); ++c) {
    if (std::holds_alternative<PinConstraint>(view_.set->constraints[c].rule))
      of[c].push_back(outcome_of_pins(c, uv));
    for (ConstraintOutcome& outcome : of[c]) all.push_back(std::move(outcome));
  }
  return all;
}

}  // namespace planish
