// Perceptual colours of a signed quantity: blue below, near-white at zero, orange-brown above.
#pragma once

#include <cstdint>

namespace planish {

/// sRGB, each in [0, 1].
struct Rgb {
  double r = 0, g = 0, b = 0;
};

/// Marks what has no place on the scale: flipped triangles. Far in hue from both ends.
inline constexpr Rgb kFlipColour{0.90, 0.0, 0.45};

/// Colour of x in [-1, 1] (beyond: the end's). Lightness falls evenly and equally from 0 to both ends.
/// Ref: Ottosson 2020, Oklab.
Rgb diverging_colour(double x);

/// 0xAARRGGBB with colour multiplied by alpha, both as cairo's ARGB32 has them.
std::uint32_t premultiplied(Rgb colour, double alpha);

}  // namespace planish
