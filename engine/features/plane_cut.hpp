// The curve in which a plane cuts a surface.
#pragma once

#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/embedding.hpp"
#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// A polyline on the surface. at[i].triangle holds the whole segment from point i to the next one (closed:
/// from the last to the first too); points on edges have one barycentric coordinate 0, vertices two.
struct SurfaceCurve {
  std::vector<SurfacePoint> at;
  std::vector<Vec3> position;  ///< of the same points, mesh units
  bool closed = false;         ///< the first point is not repeated
};

/// Of the curves in which a plane cuts the surface, the one nearest to a point. It passes no point twice and
/// ends on the boundary, or at a vertex where curves branch.
///
/// Every vertex has one signed distance to the plane, found once; those within rounding (8 ulps of the
/// largest coordinate) lie on it, and the curve passes through them, also along edges between them. The
/// curves are those of the plane moved up and down by less than any number, with their points at vertices on
/// the plane drawn back to them. So where triangles lie in the plane, the curves follow their border on
/// either side, not their inside; where the surface touches the plane along edges, the edges are a curve;
/// a vertex that only touches it is none.
/// Direction: the side of the normal is on the left, seen from the front (along edges touched from one side:
/// either). A closed curve starts at the point nearest to `near`.
///
/// Fails: FeatureBroken: a value is not finite, the normal is zero, the plane misses the surface (the distance
/// is stated) or only touches it in points.   Cost: O(T) in parallel, 9 bytes a vertex or triangle.
Result<SurfaceCurve> plane_cut(const Exec& exec, const Surface& surface, const Topology& topology,
                               const std::string& name, const PlaneCutSource& source);

}  // namespace planish
