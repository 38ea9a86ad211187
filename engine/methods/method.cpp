#include "engine/methods/method.hpp"

#include <array>

#include "engine/methods/abf.hpp"
#include "engine/methods/conformal_map.hpp"
#include "engine/methods/spectral.hpp"
#include "engine/methods/yamabe.hpp"

namespace planish {
namespace {

constexpr const char* kNoSizes =
    "conformal maps know shapes up to a factor, and have no way to give a feature the size it asks for";

/// The factor that a constraint prescribes, where it prescribes one; null: it has none.
Scale* scale_of(Constraint& constraint) {
  if (auto* line = std::get_if<LineConstraint>(&constraint.rule))
    return line->lengths == LineConstraint::Lengths::Scale ? &line->scale : nullptr;
  if (auto* circle = std::get_if<CircleConstraint>(&constraint.rule)) return &circle->scale;
  if (auto* curve = std::get_if<CurveConstraint>(&constraint.rule)) return &curve->scale;
  if (auto* region = std::get_if<RegionConstraint>(&constraint.rule)) return &region->scale;
  return nullptr;
}

const char* conformal_refusal(const Constraint& constraint) {
  if (const auto* circle = std::get_if<CircleConstraint>(&constraint.rule); circle && circle->radius)
    return kNoSizes;
  Constraint copy = constraint;
  const Scale* scale = scale_of(copy);
  return scale && scale->factor && *scale->factor != 1 ? kNoSizes : nullptr;
}

const char* spectral_refusal(const Constraint& constraint) {
  if (std::holds_alternative<PinConstraint>(constraint.rule))
    return "an eigenvector is known up to a factor, and has no place for pins; lscm has";
  return conformal_refusal(constraint);
}

/// Shapes as templates with a free complex factor: two edges keep the ratio of their lengths and the angle between them.
/// Ref: Vaitkus and Varady, section 4.
bool free_scale(Constraint& constraint) {
  if (auto* line = std::get_if<LineConstraint>(&constraint.rule);
      line && line->lengths == LineConstraint::Lengths::Keep) {
    line->lengths = LineConstraint::Lengths::Scale;
    line->scale = {.factor = std::nullopt, .group = {}};
    return true;
  }
  Scale* scale = scale_of(constraint);
  if (scale == nullptr || !scale->factor) return false;
  scale->factor.reset();
  return true;
}

constexpr std::array kMethods = {
    MapMethod{Method::Lscm, conformal_refusal, free_scale, true, pinned_conformal_map},
    MapMethod{Method::Dncp, conformal_refusal, free_scale, true, pinned_conformal_map},
    MapMethod{Method::Spectral, spectral_refusal, free_scale, true, spectral_map},
    MapMethod{Method::Abf, angle_refusal, free_lengths, true, angle_based_map},
    MapMethod{Method::Yamabe, scale_refusal, free_lengths, false, conformal_scale_map},
};

}  // namespace

const MapMethod* find_map_method(Method method) {
  for (const MapMethod& m : kMethods) {
    if (m.method == method) return &m;
  }
  return nullptr;
}

Result<Loosened> loosen(const MapMethod& method, const ConstraintSet& set) {
  Loosened result{.set = set, .up_to_scale = {}};
  std::vector<Index> refused;
  std::string reason;
  for (Index k = 0; k < static_cast<Index>(set.constraints.size()); ++k) {
    Constraint& constraint = result.set.constraints[k];
    if (const char* why = method.refusal(constraint)) {
      refused.push_back(k);
      const std::string whole = "\"" + constraint.name + "\": " + why;
      if (reason.find(why) == std::string::npos) reason += (reason.empty() ? "" : "; ") + whole;
    } else if (method.loosen(constraint)) {
      result.up_to_scale.push_back(constraint.name);
    }
  }
  if (refused.empty()) return result;
  Error error = constraint_error(ErrorCode::ConstraintUnsupported, set, refused.front(), "");
  error.what = std::string("method ") + name(method.method) + " cannot express " + reason;
  error.element = ElementKind::Constraint;
  error.count = static_cast<Offset>(refused.size());
  refused.resize(std::min(refused.size(), kMaxListedIds));
  error.ids = std::move(refused);
  return fail(error);
}

}  // namespace planish
