// One polyline into the edges of a refined mesh.
#pragma once

#include <string>
#include <vector>

#include "engine/features/refined_mesh.hpp"
#include "engine/model/error.hpp"

namespace planish {

/// A polyline with its places on the surface.
struct CurveOnSurface {
  std::string name;
  In<SurfacePoint> at;  ///< [n] on the input mesh
  In<Vec3> given;       ///< [n] as drawn, mesh units
  bool closed = false;
  double allowed = 0;  ///< distance from the drawn segments that the path may have, mesh units
};

/// Points nearer than this share of the shortest edge of their triangle to a vertex or an edge move onto it: no
/// triangle thinner than that is made where a shape can do without.
inline constexpr double kSnapShare = 1e-3;

/// The chain of vertices that stands for a curve. A closed one does not repeat its first vertex.
struct EmbeddedCurve {
  std::vector<Index> vertex;
  double deviation = 0;  ///< largest distance between chain and drawn polyline, mesh units
  Index snapped = 0;     ///< points that were moved onto a vertex or an edge
};

/// Cuts a curve into the mesh; its edges are constrained.
/// Fails: FeatureLeavesSurface (names the two points between which no path stays near the polyline); FeatureBroken
///        (the chain has fewer than two, closed three, vertices, or turns back on itself).
/// Cost: O(triangles crossed).
Result<EmbeddedCurve> embed_curve(RefinedMesh& mesh, const Surface& input, const CurveOnSurface& curve);

}  // namespace planish
