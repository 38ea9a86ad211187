// The strip under a picture: colour scale, figures, size and scale bar.
#pragma once

#include "engine/model/flattening.hpp"
#include "io/canvas.hpp"

namespace planish {

/// What the strip tells.
struct Legend {
  double limit = 0.1;                        ///< stretch minus 1 at the ends of the colour scale, > 0
  const Certificate* certificate = nullptr;  ///< null: no figures
  Index triangles = 0;
  Vec2 panel_size;  ///< of the panel, mesh units
  double pixels_a_unit = 1;
};

inline constexpr double kLegendHeight =
    190;  ///< at a picture of 1600 pixels; everything scales with the width

/// Draws the strip below `top` between the margins; `unit` is the picture's width / 1600.
void draw_legend(Canvas& canvas, const Legend& legend, double top, double margin, double unit);

/// The largest 1, 2 or 5 times a power of ten that is <= x; x > 0 and finite.
double round_down(double x);

}  // namespace planish
