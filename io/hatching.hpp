// Regions of a drawing marked by parallel lines, which leave what lies below readable.
#pragma once

#include <vector>

#include "io/canvas.hpp"

namespace planish {

/// Lines from points 2 i to 2 i + 1: the parts inside the loops (where an odd number of them winds around) of
/// parallel lines at multiples of `spacing` from the origin. Loops need not repeat their first point.
std::vector<Vec2> hatch(In<std::vector<Vec2>> loops, Vec2 direction, double spacing);

/// Between hatching lines of a region, at a picture of 1600 pixels.
inline constexpr double kHatchSpacing = 15;

/// A region's border and hatching in the colour of the feature with this number; neighbours in number have
/// different directions.
///   spacing pixels, at least 3;  unit: the picture's width / 1600
void draw_hatched(Canvas& canvas, In<std::vector<Vec2>> loops, std::size_t number, double spacing,
                  double unit);

}  // namespace planish
