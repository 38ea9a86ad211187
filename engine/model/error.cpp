#include "engine/model/error.hpp"

#include <array>

namespace planish {
namespace {

struct CodeEntry {
  ErrorCode code;
  const char* name;
  int exit_code;
  const char* remedy;
};

constexpr std::array kCodes = {
    CodeEntry{ErrorCode::InternalDefect, "internal-defect", 1, "please report it with the input"},
    CodeEntry{ErrorCode::BadUsage, "usage", 2, ""},
    CodeEntry{ErrorCode::NotBuilt, "not-built", 2, "build planish with this part"},
    CodeEntry{ErrorCode::CannotOpen, "cannot-open", 3, ""},
    CodeEntry{ErrorCode::UnknownFormat, "unknown-format", 3,
              "use .obj, .ply, .stl or .off, optionally with .gz"},
    CodeEntry{ErrorCode::BadSyntax, "bad-syntax", 3, ""},
    CodeEntry{ErrorCode::Truncated, "truncated", 3, "write the file again"},
    CodeEntry{ErrorCode::IndexOutOfRange, "index-out-of-range", 3, ""},
    CodeEntry{ErrorCode::NoTriangles, "no-triangles", 4, "give a mesh with faces"},
    CodeEntry{ErrorCode::NonFinitePosition, "non-finite-position", 4, "correct or remove them"},
    CodeEntry{ErrorCode::RepeatedVertex, "repeated-vertex", 4, "use --repair to drop them"},
    CodeEntry{ErrorCode::DuplicateTriangle, "duplicate-triangle", 4, "use --repair to drop the copies"},
    CodeEntry{ErrorCode::DegenerateTriangle, "degenerate-triangle", 4, "use --repair to remove them"},
    CodeEntry{ErrorCode::NonManifoldEdge, "non-manifold-edge", 4,
              "remove the extra sheets, or split the part: --repair does not mend these"},
    CodeEntry{ErrorCode::NonManifoldVertex, "non-manifold-vertex", 4, "use --repair to split them"},
    CodeEntry{ErrorCode::InconsistentOrientation, "inconsistent-orientation", 4,
              "use --repair to turn triangles"},
    CodeEntry{ErrorCode::NotOrientable, "not-orientable", 4, "cut the surface open"},
    CodeEntry{ErrorCode::ClosedComponent, "closed-component", 4,
              "use --cut auto, or name a seam that opens it"},
    CodeEntry{ErrorCode::HasHandles, "has-handles", 4, "use --cut auto, or name seams that open each handle"},
    CodeEntry{ErrorCode::TooLarge, "too-large", 4, "split the mesh"},
    CodeEntry{ErrorCode::NoParameterization, "no-parameterization", 4,
              "give a file that flatten wrote, or another one with uv: vt, s t, u v, texture_u texture_v, "
              "texcoord"},
    CodeEntry{ErrorCode::ReportOfOtherMesh, "report-of-other-mesh", 3,
              "give the report that was written together with this mesh"},
    CodeEntry{ErrorCode::FeatureTooFar, "feature-too-far", 5,
              "move the point to the surface, or raise max_distance"},
    CodeEntry{ErrorCode::FeatureLeavesSurface, "feature-leaves-surface", 5,
              "end the polyline where the surface ends"},
    CodeEntry{ErrorCode::FeatureBroken, "feature-broken", 5, ""},
    CodeEntry{ErrorCode::FeaturesOverlap, "features-overlap", 5,
              "turn one of them around, or end it earlier"},
    CodeEntry{ErrorCode::RegionBroken, "region-broken", 5, ""},
    CodeEntry{ErrorCode::ConstraintInvalid, "constraint-invalid", 5, ""},
    CodeEntry{ErrorCode::ConstraintsConflict, "constraints-conflict", 5, "drop or change one of them"},
    CodeEntry{ErrorCode::ConstraintUnsupported, "constraint-unsupported", 5,
              "change it, or use --method arap, which takes all"},
    CodeEntry{ErrorCode::FactorizationFailed, "factorization-failed", 1, "please report it with the input"},
    CodeEntry{ErrorCode::ResidualTooLarge, "residual-too-large", 1, "please report it with the input"},
    CodeEntry{ErrorCode::NoConvergence, "no-convergence", 4, "use --method arap"},
    CodeEntry{ErrorCode::OutOfMemory, "out-of-memory", 4, "use a smaller mesh or a larger machine"},
    CodeEntry{ErrorCode::CannotWrite, "cannot-write", 7, ""},
    CodeEntry{ErrorCode::Cancelled, "cancelled", 130, ""},
};

const CodeEntry& entry(ErrorCode code) {
  for (const CodeEntry& e : kCodes) {
    if (e.code == code) return e;
  }
  return kCodes.front();
}

std::string plural(ElementKind element, bool many) {
  switch (element) {
    case ElementKind::None: return "";
    case ElementKind::Vertex: return many ? "vertices" : "vertex";
    case ElementKind::Triangle: return many ? "triangles" : "triangle";
    case ElementKind::Edge: return many ? "edges" : "edge";
    case ElementKind::Component: return many ? "components" : "component";
    case ElementKind::Property: return many ? "properties" : "property";
    case ElementKind::Point: return many ? "points" : "point";
    case ElementKind::Constraint: return many ? "constraints" : "constraint";
  }
  return "";
}

/// " (triangles 3, 8, 12 and 40 more)"; edges as vertex pairs 3-8.
std::string listed_elements(const Error& error) {
  if (error.element == ElementKind::None || error.ids.empty()) return "";
  constexpr std::size_t kShown = 5;
  const std::size_t stride = error.element == ElementKind::Edge ? 2 : 1;
  const std::size_t shown = std::min(kShown, error.ids.size() / stride);
  std::string text = " (" + plural(error.element, error.count > 1) + " ";
  for (std::size_t i = 0; i < shown; ++i) {
    if (i > 0) text += ", ";
    text += std::to_string(error.ids[i * stride]);
    if (stride == 2) text += "-" + std::to_string(error.ids[i * stride + 1]);
  }
  if (error.count > static_cast<Offset>(shown)) {
    text += " and " + std::to_string(error.count - static_cast<Offset>(shown)) + " more";
  }
  return text + ")";
}

std::string position(const Place& place) {
  std::string text = place.file;
  if (place.line > 0) {
    text += ":" + std::to_string(place.line);
    if (place.column > 0) text += ":" + std::to_string(place.column);
  } else if (place.byte >= 0) {
    text += ": byte " + std::to_string(place.byte);
  }
  if (!place.pointer.empty()) text += (text.empty() ? "" : ": ") + place.pointer;
  return text.empty() ? text : text + ": ";
}

}  // namespace

const char* name(ErrorCode code) { return entry(code).name; }
const char* remedy(ErrorCode code) { return entry(code).remedy; }
int exit_code(ErrorCode code) { return entry(code).exit_code; }

const char* name(ElementKind element) {
  switch (element) {
    case ElementKind::None: return "none";
    case ElementKind::Vertex: return "vertex";
    case ElementKind::Triangle: return "triangle";
    case ElementKind::Edge: return "edge";
    case ElementKind::Component: return "component";
    case ElementKind::Property: return "property";
    case ElementKind::Point: return "point";
    case ElementKind::Constraint: return "constraint";
  }
  return "none";
}

std::string describe(const Error& error) {
  std::string text = position(error.place) + error.what + listed_elements(error);
  if (!error.also.empty()) text += "; also " + error.also;
  const std::string advice = remedy(error.code);
  if (!advice.empty()) text += "; " + advice;
  return text + " [" + name(error.code) + "]";
}

}  // namespace planish
