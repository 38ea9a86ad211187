// Maps whose residuals are known, with a report that tells the truth about them until a test changes it.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

#include "engine/verify.hpp"
#include "tests/support/shapes.hpp"

namespace planish::tests {

constexpr Index kSide = 9;  // vertices a side of the square, edge 1/4, vertex kSide * row + column

/// A flat mesh, a square unless another is given, with its own shape for a map: every residual is known.
struct Case {
  Mesh mesh;
  std::vector<Vec2> uv = {};  ///< [3 T]
  Claims claims = {};
  ConstraintSet set = {};

  Case() : Case(shapes::height_field(kSide, shapes::flat, 0)) {}

  explicit Case(Mesh shape) : mesh(std::move(shape)) {
    for (const Index v : mesh.corner_vertex) uv.push_back({mesh.position[v].x, mesh.position[v].y});
    const Verification found = *verify(mesh.surface(), uv);
    claims.certificate = found.certificate;
    claims.mesh.vertices = mesh.num_vertices();
    claims.mesh.triangles = mesh.num_triangles();
    claims.mesh.components = claims.mesh.boundary_loops = claims.mesh.euler = 1;
  }

  Vec2 place(Index v) const { return {mesh.position[v].x, mesh.position[v].y}; }

  /// A chain feature, and the outcome of a constraint that keeps its shape.
  ConstraintOutcome& add(const std::string& name, const std::string& type, std::vector<Index> chain,
                         bool closed = false) {
    Feature feature;
    feature.name = name;
    feature.vertex = std::move(chain);
    feature.closed = closed;
    const std::size_t n = feature.vertex.size();
    ConstraintOutcome outcome{
        .name = type + " " + name, .type = type, .features = {name}, .scale = 1.0, .orientation = 0.0};
    for (std::size_t k = 0; k < n; ++k) {
      outcome.shape.push_back(place(feature.vertex[k]));
      if (k + 1 < n || closed) feature.length += norm(place(feature.vertex[(k + 1) % n]) - outcome.shape[k]);
    }
    claims.features.push_back(std::move(feature));
    claims.constraints.push_back(std::move(outcome));
    return claims.constraints.back();
  }

  void move(Index v, Vec2 by) {
    for (std::size_t c = 0; c < uv.size(); ++c) {
      if (mesh.corner_vertex[c] == v) uv[c] += by;
    }
  }

  Verification found(bool with_set = false) const {
    const auto result = verify(mesh.surface(), uv, {.claims = &claims, .set = with_set ? &set : nullptr});
    REQUIRE(result);
    return *result;
  }
};

inline std::vector<Index> row(Index r) {
  std::vector<Index> chain;
  for (Index k = 0; k < kSide; ++k) chain.push_back(kSide * r + k);
  return chain;
}

/// Four edges around an interior vertex's square.
inline const std::vector<Index> kSquare = {2 * kSide + 2, 2 * kSide + 3, 2 * kSide + 4, 3 * kSide + 4,
                                           4 * kSide + 4, 4 * kSide + 3, 4 * kSide + 2, 3 * kSide + 2};

/// Constraints first, then the report as a whole.
inline std::string faults(const Verification& v) {
  std::string text;
  for (const ConstraintFinding& finding : v.constraints) {
    for (const std::string& fault : finding.faults) text += finding.name + ": " + fault + "\n";
  }
  for (const std::string& fault : v.faults) text += fault + "\n";
  return text;
}

inline bool says(const Verification& v, const std::string& part) {
  return faults(v).find(part) != std::string::npos;
}

/// The case after a change does not hold, and says so.
inline void check_fault(const Case& changed, const std::string& part, bool with_set = false) {
  CAPTURE(part);
  const Verification found = changed.found(with_set);
  CHECK(!found.holds());
  CHECK_MESSAGE(says(found, part), faults(found));
}

inline Constraint constraint(const std::string& name, const std::string& type,
                             decltype(Constraint::rule) rule) {
  return {.name = name, .type = type, .rule = std::move(rule)};
}

}  // namespace planish::tests
