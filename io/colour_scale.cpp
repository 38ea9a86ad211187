#include "io/colour_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace planish {
namespace {

/// A colour in Oklab's polar form; hue in radians.
struct Oklch {
  double lightness, chroma, hue;
};

double encode_srgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

double cube(double x) { return x * x * x; }

Rgb to_rgb(const Oklch& c) {
  const double a = c.chroma * std::cos(c.hue), b = c.chroma * std::sin(c.hue);
  const double l = cube(c.lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(c.lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(c.lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {encode_srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encode_srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encode_srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

// Chroma and hue at evenly spaced places from zero to an end; the largest chroma that sRGB holds at that
// lightness, less a little, so that no colour is clipped.
struct Knot {
  double chroma, degrees;
};
constexpr std::array<Knot, 5> kBelow{{{0.003, 250}, {0.060, 245}, {0.112, 248}, {0.128, 254}, {0.118, 260}}};
constexpr std::array<Knot, 5> kAbove{{{0.003, 80}, {0.066, 76}, {0.120, 64}, {0.126, 52}, {0.100, 44}}};
constexpr double kLightnessAtZero = 0.955;
constexpr double kLightnessAtEnd = 0.375;

}  // namespace

Rgb diverging_colour(double x) {
  const auto& knots = x < 0 ? kBelow : kAbove;
  const double distance = std::min(std::abs(x), 1.0);
  constexpr int kSpans = static_cast<int>(kBelow.size()) - 1;
  const int k = std::min(static_cast<int>(distance * kSpans), kSpans - 1);
  const double f = distance * kSpans - k;
  const double degrees = std::lerp(knots[k].degrees, knots[k + 1].degrees, f);
  return to_rgb({std::lerp(kLightnessAtZero, kLightnessAtEnd, distance),
                 std::lerp(knots[k].chroma, knots[k + 1].chroma, f), degrees * 3.14159265358979323846 / 180});
}

std::uint32_t premultiplied(Rgb colour, double alpha) {
  const auto byte = [](double x) {
    return static_cast<std::uint32_t>(std::lround(255 * std::clamp(x, 0.0, 1.0)));
  };
  return byte(alpha) << 24 | byte(alpha * colour.r) << 16 | byte(alpha * colour.g) << 8 |
         byte(alpha * colour.b);
}

}  // namespace planish
