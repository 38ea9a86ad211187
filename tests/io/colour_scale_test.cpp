#include "io/colour_scale.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

namespace planish {
namespace {

double luminance(Rgb c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

TEST_CASE("colour_scale: darkens evenly from zero to both ends, without clipped colours") {
  for (const double side : {-1.0, 1.0}) {
    for (int k = 1; k <= 100; ++k) {
      const Rgb inner = diverging_colour(side * (k - 1) / 100), outer = diverging_colour(side * k / 100);
      CHECK(luminance(outer) < luminance(inner));
      for (const double channel : {outer.r, outer.g, outer.b}) {
        CHECK(channel > 0);
        CHECK(channel < 1);
      }
    }
  }
}

TEST_CASE("colour_scale: below zero is blue, above is orange, zero is near white") {
  CHECK(diverging_colour(-0.7).b > diverging_colour(-0.7).r + 0.3);
  CHECK(diverging_colour(0.7).r > diverging_colour(0.7).b + 0.3);
  CHECK(luminance(diverging_colour(0)) > 0.9);
  CHECK(std::abs(diverging_colour(0).r - diverging_colour(0).b) < 0.03);
}

TEST_CASE("colour_scale: values beyond the ends have the ends' colours") {
  CHECK(diverging_colour(7).r == diverging_colour(1).r);
  CHECK(diverging_colour(-7).b == diverging_colour(-1).b);
}

TEST_CASE("colour_scale: premultiplied pixels are alpha, red, green, blue from the highest byte") {
  CHECK(premultiplied({1, 0.5, 0}, 1) == 0xFFFF8000u);
  CHECK(premultiplied({1, 1, 0}, 0.2) == 0x33333300u);
  CHECK(premultiplied({1, 1, 1}, 0) == 0);
}

}  // namespace
}  // namespace planish
