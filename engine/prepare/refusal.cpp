#include <string>

#include "engine/prepare/validate.hpp"

namespace planish {
namespace {

/// What is said of a kind of defect; the ids follow.
std::string sentence(const Defect& defect) {
  if (!defect.what.empty()) return defect.what;
  const std::string n = std::to_string(defect.count);
  const bool one = defect.count == 1;
  const auto with = [&](const char* singular, const char* plural) {
    return n + " " + (one ? singular : plural);
  };
  switch (defect.code) {
    case ErrorCode::NoTriangles: return "the mesh has no triangles";
    case ErrorCode::NonFinitePosition:
      return with("vertex has a coordinate that is not a finite number",
                  "vertices have a coordinate that is not a finite number");
    case ErrorCode::RepeatedVertex:
      return with("triangle names a vertex twice", "triangles name a vertex twice");
    case ErrorCode::DuplicateTriangle:
      return with("triangle is a copy of an earlier one", "triangles are copies of earlier ones");
    case ErrorCode::DegenerateTriangle:
      return with("triangle has no area within the precision of its coordinates",
                  "triangles have no area within the precision of their coordinates");
    case ErrorCode::NonManifoldEdge:
      return with("edge has more than two triangles", "edges have more than two triangles");
    case ErrorCode::NonManifoldVertex:
      return with("vertex joins triangles that form no single fan",
                  "vertices join triangles that form no single fan");
    case ErrorCode::InconsistentOrientation:
      return with("edge has its two triangles facing opposite sides",
                  "edges have their two triangles facing opposite sides");
    case ErrorCode::NotOrientable:
      return with("component that cannot be oriented (one-sided)",
                  "components that cannot be oriented (one-sided)");
    case ErrorCode::ClosedComponent: return with("component without boundary", "components without boundary");
    case ErrorCode::HasHandles:
      return with("component with handles (genus above 0)", "components with handles (genus above 0)");
    default: return n + " " + name(defect.code);
  }
}

}  // namespace

Error refusal(const Diagnosis& diagnosis) {
  const Defect& first = diagnosis.defects.front();
  Error error{.code = first.code,
              .what = sentence(first),
              .place = {},
              .element = first.element,
              .ids = first.ids,
              .count = first.count};
  for (std::size_t i = 1; i < diagnosis.defects.size(); ++i) {
    error.also += (i == 1 ? "" : ", ") + sentence(diagnosis.defects[i]);
  }
  return error;
}

Result<void> check_manifold(const Exec& exec, const Surface& surface) {
  auto diagnosis = diagnose(exec, surface);
  if (!diagnosis) return fail(diagnosis.error());
  std::erase_if(diagnosis->defects, [](const Defect& defect) {
    return defect.code == ErrorCode::ClosedComponent || defect.code == ErrorCode::HasHandles;
  });
  return diagnosis->usable() ? Result<void>() : fail(refusal(*diagnosis));
}

}  // namespace planish
