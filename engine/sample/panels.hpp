// Scan-like meshes of any size, with the features that a person would constrain on them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// A free polyline on the smooth surface that was sampled.
struct SampleFeature {
  std::string name;
  std::vector<Vec3> points;  ///< mesh units; a closed one does not repeat its first point
  bool closed = false;
  double max_distance =
      0;  ///< bound for the way from a point to the mesh: coarse meshes and noise are farther off
};

/// A constraint of the file format of DESIGN 4.2.
struct SampleConstraint {
  std::string type;                   ///< "line", "circle", "curve", "angle", "perpendicular"
  std::vector<std::string> features;  ///< one, or two for a relation
  std::optional<double> degrees;      ///< of an angle
};

struct Sample {
  Mesh mesh;
  std::vector<Vec2>
      flat;  ///< [V] isometric unrolling of a developable kind without noise; empty for the others
  std::vector<SampleFeature> features;
  std::vector<SampleConstraint> constraints;
};

inline constexpr Index kMostSpreadFeatures = 100'000;

struct SampleOptions {
  std::string kind;         ///< one of sample_kinds()
  Index triangles = 10000;  ///< wanted, >= 32; the mesh comes within 5% of it
  double noise = 0;         ///< amplitude along the normal, mesh units (metres), >= 0
  std::uint64_t seed = 1;   ///< same seed, same bits
  Index feature_count = 0;  ///< disjoint lines and circles spread over the panel, <= kMostSpreadFeatures; 0:
                            ///< the features of the kind
};

/// "hood", "fender", "door", "cylinder", "cone", "tangent-developable", "sphere-cap", "annulus".
const std::vector<std::string>& sample_kinds();

/// One component, oriented with the normals outward, one boundary loop (annulus: two), no degenerate
/// triangle. Fails: BadUsage (unknown kind, too few or too many triangles, negative noise, too many
/// features).
/// Cost: O(T + features), parallel.
Result<Sample> make_sample(const Exec& exec, const SampleOptions& options);

}  // namespace planish
