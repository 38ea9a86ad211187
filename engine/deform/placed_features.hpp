// Features in their prescribed shapes, placed where they lie nearest to a map, and their way there (DESIGN 3.7).
#pragma once

#include "engine/constraints/system.hpp"

namespace planish {

struct PlacedFeatures {
  std::unique_ptr<Poses> poses;  ///< closed
  std::vector<Vec2> shift;       ///< per assembly: its translation, 0 where pins hold it

  Vec2 translation(const Assemblies& assemblies, Index body) const {
    return shift[assemblies.of[body]] + poses->translation(body);
  }
  Vec2 point(const Assemblies& assemblies, const Owner& owner) const {
    return shift[assemblies.of[owner.body]] + poses->point(owner.body, owner.place);
  }
};

/// Each body by Procrustes, angles between two of them by equal and opposite turns about their centroids, joints by least
/// changes of the poses.
///   system: oriented at the map;  uv [V] units of the ordered mesh
/// Fails: as ConstraintSystem::poses_at().
Result<PlacedFeatures> place_features(const ConstraintSystem& system, In<Vec2> uv);

/// A vertex and its place.
using PlacedVertex = std::pair<Index, Vec2>;

/// The way of features from a map to where they are placed. Poses go evenly from those that fit the map best; in their
/// frames lines and circles flow (flow_curve), curves and regions go straight.
class FeatureMotion {
 public:
  /// from [V]: the map where it begins.   system must outlive the motion.
  FeatureMotion(const ConstraintSystem& system, const PlacedFeatures& placed, In<Vec2> from);

  /// Places of all feature vertices and pins after a share of the way, in (0, 1]; 1 is where they are placed, to the bit.
  std::vector<PlacedVertex> at(double share) const;

 private:
  std::vector<Vec2> shape_at(Index body, double share) const;

  const ConstraintSystem& system_;
  struct BodyMotion {
    Vec2 centroid, factor;          // of the fit to the map
    Vec2 translation, last_factor;  // where it is placed
    std::vector<Vec2> from, to;     // [vertex] in the template's frame
  };
  std::vector<BodyMotion> bodies_;
  std::vector<PlacedVertex> last_;
  std::vector<Vec2> first_;  // of the vertices in last_, on the map
};

}  // namespace planish
