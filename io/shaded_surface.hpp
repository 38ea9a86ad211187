// A surface in space as it is seen: shaded by the light, tinted, with its wireframe and its boundary.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "io/canvas.hpp"
#include "io/depth_raster.hpp"

namespace planish {

/// Pixels of depth by which what is seen may lie behind the surface.
inline constexpr double kDepthSlack = 1.5;

/// Triangles as they are seen, in the panel that shows them; the caller's arrays.
struct SeenTriangles {
  In<Index> corner_vertex;    ///< [3 T]
  In<Vec3> point;             ///< [V] pixels, as in ShadedTriangles
  In<Index> tint;             ///< [T] or empty: number of a colour, or kNone
  In<Rgb> tint_colour;        ///< as in ShadedTriangles
  int width = 0, height = 0;  ///< of the panel, pixels
};

/// Light falls from the upper left on whichever side is seen; a nearly flat surface gets more contrast, so
/// that its shape shows. Same bits for any number of threads.   Cost: O(T + pixels).
DepthRaster shade_surface(const Exec& exec, const SeenTriangles& triangles);

/// The shaded surface with those of its edges that are seen, as large as the panel, on a PNG canvas.
///   surface: of the same triangles;  unit: the picture's width / 1600
/// Cost: O(T + pixels).
Canvas draw_surface(const Exec& exec, const SeenTriangles& triangles, const DepthRaster& surface,
                    double unit);

}  // namespace planish
