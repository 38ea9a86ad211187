// Polylines drawn in space, brought onto the surface point by point.
#pragma once

#include <vector>

#include "engine/features/surface_locator.hpp"
#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// How far a polyline may be from the surface: its max_distance, or 1% of its length; mesh units.
double allowed_distance(const PolylineSource& source);

/// The points of one polyline on the surface.
struct Projection {
  std::vector<SurfacePoint> at;  ///< [points]
  std::vector<Vec3> position;    ///< [points] mesh units
  double max_distance = 0;       ///< largest distance between a point and its projection, mesh units
};

/// Each point goes to the closest point of the surface, unless that lies on another sheet than the point
/// before (a folded flange, the other component of an assembly): then to the closest point of the same sheet.
/// Two points are on one sheet where a path on the surface joins them within a capsule around the segment
/// between the given points. Which sheet a polyline is on is what the largest part of its points says, by the
/// sum of squared distances. Where no path leads on within max_distance (a hole between two points), the
/// closest point of the same component is kept.
///   topology: of the same surface;  locator: of the same surface;  spec.source: a PolylineSource
/// Fails: BadUsage (the source is no polyline); FeatureBroken (fewer than two points, closed: three; repeated
/// or not finite ones); FeatureTooFar (points farther away than max_distance, default 1% of the length);
/// FeatureLeavesSurface (points on another component, the rest being on one). Ids: 0-based points.
/// Cost: O(log T) a point, and the triangles along the polyline.
Result<Projection> project(const Exec& exec, const Surface& surface, const Topology& topology,
                           const SurfaceLocator& locator, const FeatureSpec& spec);

/// All polylines among `specs`, in parallel over polylines and points; specs of other kinds get an empty
/// projection. Fails: as above, the first polyline that fails; `also` names the others.
Result<std::vector<Projection>> project(const Exec& exec, const Surface& surface, const Topology& topology,
                                        const SurfaceLocator& locator, In<FeatureSpec> specs);

}  // namespace planish
