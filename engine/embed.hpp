// The facade for features alone: a mesh and feature specs in, a mesh whose edges contain the features out.
#pragma once

#include "engine/model/constraint.hpp"
#include "engine/model/embedding.hpp"
#include "engine/model/error.hpp"
#include "engine/model/monitor.hpp"

namespace planish {

struct EmbedOptions {
  int threads = 0;  ///< 0: the arena of the calling thread
};

/// Finds every feature of the set on the surface and cuts the curves among them into its edges. The surface does not
/// move: new vertices lie on its triangles. Original vertices keep their numbers and bits. Chains that cross or
/// touch share a vertex there. Where constraints prescribe the shape of chains, triangles that this would force
/// flat are split (DESIGN 3.2). Closed and higher-genus surfaces are welcome.
/// Fails: the defects of diagnose() but ClosedComponent and HasHandles; FeatureTooFar,
///        FeatureLeavesSurface, FeatureBroken, FeaturesOverlap, RegionBroken, ConstraintInvalid (a
///        constraint that names vertices or edges which do not exist) (place.pointer names the feature's place
///        in its file); Cancelled; NotBuilt.
/// Cost: O(T) once, then O(triangles crossed).
/// Ref: Vaitkus and Varady, feature curves (section 2); points projected by closest point, joined by plane sections.
Result<Embedding> embed(const Surface& surface, const ConstraintSet& set, const EmbedOptions& options = {},
                        const Monitor& monitor = {});

}  // namespace planish
