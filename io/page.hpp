// What all pictures have in common: colours, margins, title, and which files and sizes are allowed.
#pragma once

#include <string>

#include "io/canvas.hpp"

namespace planish {

inline constexpr Rgb kInk{0.13, 0.13, 0.14};
inline constexpr Rgb kPale{0.42, 0.42, 0.45};
inline constexpr Rgb kPaper{1, 1, 1};

/// Sizes at a picture of 1600 pixels; all but the wireframe scale with the width.
inline constexpr double kMargin = 48, kTitleSize = 30, kTitleHeight = 58, kGap = 36, kSmallestPanel = 80;
inline constexpr double kTitleBaseline = kMargin + 0.8 * kTitleSize;

/// The format that the path's extension asks for.
/// Fails: UnknownFormat for other extensions than .svg and .png; BadUsage (width not in [200, 8000]).
Result<Canvas::Format> check_page(const std::string& path, int width);

/// Where lines and names of features may go: the panel and a part of what is free around it.
PixelBox around_panel(Vec2 panel_corner, int panel_height, int width);

/// As much of the title as fits into `room`, at the page's upper left; `unit` is the picture's width / 1600.
void draw_title(Canvas& canvas, const std::string& title, double room, double unit);

}  // namespace planish
