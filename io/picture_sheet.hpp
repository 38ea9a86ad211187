// Several maps of one surface as a picture, side by side at one scale.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/picture.hpp"

namespace planish {

/// A map, what was measured on it, and what is said above it.
struct SheetMap {
  In<Vec2> uv;  ///< [V]
  const Certificate* certificate = nullptr;
  In<PlacedFeature> features = {};
  std::vector<std::string> caption = {};  ///< lines, the first one bold
};

/// The surface in space, before its maps; its features are those of the last map.
struct SheetModel {
  std::vector<std::string> caption;  ///< as a map's
};

/// Writes all maps to one scale and one scale of colours, row by row, in as many columns as make the sheet about as wide as
/// high and a half; maps without captions in one row, and then the figures below are those of the last one.
/// Above maps with captions, the lines and circles that features were to become are left out.
/// The features of the last map are named and listed, those of the others have the same colours.
/// With a model, the surface as choose_view() sees it is the first panel, at the maps' scale, and each map is turned to lie as
/// the model is seen: by the rotation that brings its edges nearest to the model's. Names then stand on the model alone.
///   maps [n >= 1];  options: its features, window, figures, captions, copies, names and model are set here
/// Fails, cost: as write_picture(), n times.
Result<void> write_picture_sheet(const Exec& exec, const std::string& path, const Surface& surface,
                                 In<SheetMap> maps, PictureOptions options,
                                 const std::optional<SheetModel>& model = {});

}  // namespace planish
