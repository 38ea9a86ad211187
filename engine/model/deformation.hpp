// What deforming a given map results in.
#pragma once

#include "engine/model/flattening.hpp"
#include "engine/model/options.hpp"

namespace planish {

/// How a given map was deformed, beside the result itself.
struct DeformFacts {
  Reference reference = Reference::Surface;
  int steps = 1;
  double map_scale = 1;   ///< what the given map was multiplied with to come to mesh units
  Index mirrored = 0;     ///< components that lay with their back up, and were turned over
  bool released = false;  ///< features left the places nearest to the given map, because flips remained there
  double given_arap = 0;  ///< of the given map in mesh units, per rest area
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
