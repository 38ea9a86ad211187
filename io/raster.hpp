// Triangles with one value each as pixels: four samples a pixel, averaged. Dense meshes cost what their
// pixels cost.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/exec/parallel.hpp"

namespace planish {

/// Pixels row by row from the top, premultiplied ARGB (cairo's ARGB32); 0 where nothing is.
struct Raster {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixel;
};

/// Value of a flipped triangle: drawn over all others, in kFlipColour.
inline constexpr float kFlippedValue = 2;

/// Colours every sample by the triangle it lies in: exactly one of each tiling, whatever the triangles' size;
/// where images overlap the last triangle. Pixels take the colour of their samples' mean value.
///   corner_vertex [3 T];  point [V] pixels, x right, y down, in [0, width] x [0, height]
///   value [T] in [-1, 1] on the diverging scale, or kFlippedValue;  width, height at most 32000
/// Same bits for any number of threads.
/// Cost: O(T + sum of the triangles' rows + pixels), 4 to 8 bytes a
/// triangle.
Raster rasterise(const Exec& exec, In<Index> corner_vertex, In<Vec2> point, In<float> value, int width,
                 int height);

}  // namespace planish
