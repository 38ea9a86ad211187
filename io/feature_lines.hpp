// Chains of features over a picture of the surface: what is seen of them and what lies behind.
#pragma once

#include <vector>

#include "io/canvas.hpp"
#include "io/depth_raster.hpp"

namespace planish {

/// Of a chain, a part that is seen as a whole or hidden as a whole; pixels of the panel.
struct LineRun {
  std::vector<Vec2> point;
  bool seen = true;
};

/// Chain of vertices, closed or not, cut where the surface begins or ends to hide it. Points nearer to the
/// last one than can be seen are left out.
///   point [V] pixels of the panel, as in ShadedTriangles;  slack pixels, as in DepthRaster::sees
std::vector<LineRun> split_by_sight(const DepthRaster& surface, In<Vec3> point, In<Index> chain, bool closed,
                                    double slack);

/// The chain without points that would not be seen; first and last are kept.
///   point [V] pixels
std::vector<Vec2> visible_line(In<Index> chain, In<Vec2> point);

/// The line with points between its own ones, so that neighbours are at most `step` apart; a closed one ends where
/// it begins.
std::vector<Vec2> subdivided(In<Vec2> line, bool closed, double step);

/// A bold coloured line with a rim of paper; `unit` is the picture's width / 1600.
void draw_chain(Canvas& canvas, In<Vec2> line, bool closed, Rgb colour, double unit);

inline constexpr double kIdealWidth = 1.6;  ///< at a picture of 1600 pixels

/// The thin dark dashes of a line or circle that a chain was to become.
void draw_ideal(Canvas& canvas, In<Vec2> line, double unit);

/// Dashes along a line; `on` and `off` in pixels.
void draw_dashed(Canvas& canvas, In<Vec2> point, double on, double off, const Stroke& stroke);

/// Distinguishable colours; they come again, darker, where there are many.
Rgb feature_colour(std::size_t number);

}  // namespace planish
