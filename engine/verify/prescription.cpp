#include "engine/verify/prescription.hpp"

namespace planish {
namespace {

/// Fills in what the kinds of constraints say, one overload a kind.
struct Reading {
  Prescription& asked;

  void operator()(const LineConstraint& rule) {
    asked.features = {rule.feature};
    asked.free_lengths = rule.lengths == LineConstraint::Lengths::Free;
    if (rule.lengths == LineConstraint::Lengths::Keep) asked.scale = 1;
    if (rule.lengths == LineConstraint::Lengths::Scale) scaled(rule.scale);
  }
  void operator()(const CircleConstraint& rule) {
    asked.features = {rule.feature};
    asked.radius = rule.radius;
    asked.sweep_degrees = rule.sweep_degrees;
    asked.mirror = rule.mirror;
    scaled(rule.scale);
  }
  void operator()(const CurveConstraint& rule) {
    asked.features = {rule.feature};
    asked.mirror = rule.mirror;
    asked.shape = rule.shape == CurveConstraint::Shape::Plane ? Prescription::Shape::Plane
                                                              : Prescription::Shape::Geodesic;
    scaled(rule.scale);
  }
  void operator()(const RegionConstraint& rule) {
    asked.features = {rule.feature};
    scaled(rule.scale);
  }
  void operator()(const AngleConstraint& rule) {
    asked.features = rule.features;
    asked.edges = rule.edges;
    asked.measure = rule.measure;
    asked.degrees = rule.degrees;
    asked.oriented = rule.oriented;
  }
  void operator()(const DirectionConstraint& rule) {
    if (!rule.feature.empty()) asked.features = {rule.feature};
    if (rule.edge) asked.edges = {*rule.edge};
    asked.measure = rule.measure;
    asked.degrees = rule.degrees;
    asked.oriented = rule.oriented;
  }
  void operator()(const PinConstraint& rule) {
    asked.pinned = rule.vertex;
    asked.pin_uv = rule.uv;
  }

  void scaled(const Scale& scale) {
    asked.scale = scale.factor;
    asked.scale_group = scale.group;
  }
};

/// Angles that are part of the type's name.
void name_angles(Prescription& asked) {
  if (asked.type == "parallel") asked.degrees = 0;
  if (asked.type == "perpendicular") asked.degrees = 90;
}

}  // namespace

Prescription prescription_of(const Constraint& constraint) {
  Prescription asked{.of_file = true, .name = constraint.name, .type = constraint.type};
  std::visit(Reading{asked}, constraint.rule);
  name_angles(asked);
  return asked;
}

Prescription prescription_of(const ConstraintOutcome& entry) {
  Prescription asked{.name = entry.name,
                     .type = entry.type,
                     .features = entry.features,
                     .edges = entry.edges,
                     .pinned = entry.pinned,
                     .free_lengths = entry.type == "line" && entry.shape.empty()};
  name_angles(asked);
  return asked;
}

}  // namespace planish
