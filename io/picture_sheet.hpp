// Several maps of one surface as a picture, side by side at one scale.
#pragma once

#include "io/picture.hpp"

namespace planish {

/// A map, what was measured on it, and what is said above it.
struct SheetMap {
  In<Vec2> uv;  ///< [V]
  const Certificate* certificate = nullptr;
  In<PlacedFeature> features = {};
  std::vector<std::string> caption = {};  ///< lines, the first one bold
};

/// Writes all maps to one scale and one scale of colours, row by row, in as many columns as make the sheet about as wide as
/// high and a half; maps without captions in one row, and then the figures below are those of the last one.
/// Above maps with captions, the lines and circles that features were to become are left out.
/// The features of the last map are named and listed, those of the others have the same colours.
///   maps [n >= 1];  options: its features, window, figures, captions and copies are set here
/// Fails, cost: as write_picture(), n times.
Result<void> write_picture_sheet(const Exec& exec, const std::string& path, const Surface& surface,
                                 In<SheetMap> maps, PictureOptions options);

}  // namespace planish
