// Pictures read back.
#pragma once

#include <cairo.h>
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "io/colour_scale.hpp"
#include "kernels/base/types.hpp"

namespace planish::test {

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

/// To the rounding of one channel or another.
inline bool is_colour(std::uint32_t pixel, Rgb colour) {
  const std::uint32_t wanted = premultiplied(colour, 1);
  const auto near = [&](int shift) {
    return std::abs(static_cast<int>(pixel >> shift & 255) - static_cast<int>(wanted >> shift & 255)) <= 1;
  };
  return near(0) && near(8) && near(16);
}

/// A PNG; colours without alpha.
class Pixels {
 public:
  explicit Pixels(const std::string& path) : surface_(cairo_image_surface_create_from_png(path.c_str())) {
    REQUIRE(cairo_surface_status(surface_) == CAIRO_STATUS_SUCCESS);
  }
  ~Pixels() { cairo_surface_destroy(surface_); }
  Pixels(const Pixels&) = delete;
  Pixels& operator=(const Pixels&) = delete;

  int width() const { return cairo_image_surface_get_width(surface_); }
  int height() const { return cairo_image_surface_get_height(surface_); }
  std::uint32_t at(int x, int y) const {
    const unsigned char* const row =
        cairo_image_surface_get_data(surface_) +
        static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface_);
    return reinterpret_cast<const std::uint32_t*>(row)[x] & 0xFFFFFF;
  }
  std::uint32_t at(Vec2 p) const { return at(static_cast<int>(p.x), static_cast<int>(p.y)); }
  bool is(Vec2 p, Rgb colour) const { return is_colour(at(p), colour); }
  /// Pixels of rows [top, bottom) that hold.
  template <class Holds>
  int count(int top, int bottom, Holds&& holds) const {
    int n = 0;
    for (int y = top; y < bottom; ++y) {
      for (int x = 0; x < width(); ++x) n += holds(at(x, y)) ? 1 : 0;
    }
    return n;
  }

 private:
  cairo_surface_t* surface_;
};

}  // namespace planish::test
