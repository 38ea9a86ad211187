// Two maps of one surface as a picture, side by side.
#pragma once

#include "io/picture.hpp"

namespace planish {

/// A map and what was measured on it.
struct DrawnMap {
  In<Vec2> uv;  ///< [V]
  const Certificate* certificate = nullptr;
};

/// Writes both maps to one scale and one scale of colours, left and right; the figures are those of the right one.
///   options: its window and figures are set here   Fails, cost: as write_picture(), twice.
Result<void> write_picture_pair(const Exec& exec, const std::string& path, const Surface& surface,
                                const DrawnMap& left, const DrawnMap& right, PictureOptions options);

}  // namespace planish
