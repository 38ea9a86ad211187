// What deforming a given map results in.
#pragma once

#include "engine/model/flattening.hpp"
#include "engine/model/options.hpp"

namespace planish {

/// What was done with constrained elements where triangles stay flipped, or overlaps that are to be removed stay, as long as
/// they are held.
enum class Release {
  None,  ///< nothing: they lie where they lie nearest to the given map, unless their poses were free anyway
  Features,  ///< they were moved to where the whole is least distorted
  Map,       ///< the whole was flattened anew, and laid onto the given map
};

const char* name(Release release);

/// The map as it was after one of several steps, or before the first of them (0).
struct StepFacts {
  int step = 0;
  double arap = 0;  ///< per rest area
  Offset flipped = 0, overwound = 0;
};

/// How a given map was deformed, beside the result itself.
struct DeformFacts {
  Reference reference = Reference::Surface;
  int steps = 1;
  std::vector<StepFacts> way;  ///< of several steps: before the first, and after each
  FeaturePoses poses = FeaturePoses::Held;
  double map_scale = 1;  ///< what the given map was multiplied with to come to mesh units
  Index mirrored = 0;    ///< components that lay with their back up, and were turned over
  Release release = Release::None;
  double given_arap = 0;     ///< of the given map in mesh units, per rest area
  Offset given_flipped = 0;  ///< triangles with det J <= 0 in it
  /// How far vertices lie from the given map, once its components were moved onto pins and directions; mesh units.
  double largest_displacement = 0, mean_displacement = 0;
};

struct Deformation {
  Flattening flattening;
  DeformFacts facts;
};

/// One step of a gradual deformation, 0 is the given map.
struct DeformStep {
  int step = 0;
  std::vector<Vec2> uv;     ///< [V] mesh units
  Certificate certificate;  ///< of it, but for overlaps
};

}  // namespace planish
