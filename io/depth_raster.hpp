// Shaded triangles as pixels, the nearest in front, and how far the surface is at each pixel.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "io/colour_scale.hpp"
#include "io/raster.hpp"

namespace planish {

/// Part of a tint in the colour of a triangle; white is the rest.
inline constexpr double kTintShare = 0.42;

/// What is drawn; the caller's arrays.
struct ShadedTriangles {
  In<Index> corner_vertex;  ///< [3 T]
  In<Vec3> point;           ///< [V] pixels: x right, y down, both inside the picture; z towards the viewer
  In<float> grey;           ///< [V] in [0, 1], linear over each triangle
  In<Index> tint;           ///< [T] or empty: number of a colour, or kNone
  In<Rgb> tint_colour;      ///< mixed with white, times the grey of the triangles that have its number
};

struct DepthRaster {
  Raster raster;
  std::vector<float>
      depth;  ///< a pixel: the farthest of its samples' nearest points; -infinity where one is empty

  /// Is a point of the surface in front, or as good as? `slack` in pixels.
  bool sees(Vec3 point, double slack) const;
};

/// Pixels have 2 x 2 samples. Same bits for any number of threads.
/// Cost: O(T + sum of the triangles' rows + pixels), 4 to 8 bytes a triangle.
DepthRaster rasterise_depth(const Exec& exec, const ShadedTriangles& triangles, int width, int height);

}  // namespace planish
