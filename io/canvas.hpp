// Lines, text and images on a page that becomes a PNG or SVG file. Cairo stays behind this header.
#pragma once

#include <memory>
#include <string>

#include "engine/model/error.hpp"
#include "io/colour_scale.hpp"
#include "io/raster.hpp"

namespace planish {

/// A corner and the opposite one, pixels.
struct PixelBox {
  Vec2 lower, upper;
};

struct Stroke {
  Rgb colour;
  double width = 1;
  double alpha = 1;
};

enum class Anchor { Left, Centre, Right };

struct TextStyle {
  double size = 16;
  Rgb colour;
  bool bold = false;
  Anchor anchor = Anchor::Left;
};

/// Coordinates in pixels (SVG: user units of one CSS pixel), x right, y down. Drawing never fails; finish()
/// tells.
class Canvas {
 public:
  enum class Format { Png, Svg };
  Canvas(Format format, int width, int height);
  Canvas(Canvas&&) noexcept;
  ~Canvas();

  Format format() const;
  void fill_rectangle(Vec2 corner, Vec2 size, Rgb colour);
  void polyline(In<Vec2> points, bool closed, const Stroke& stroke);
  /// Lines from points 2 i to 2 i + 1.
  void segments(In<Vec2> points, const Stroke& stroke);
  void ring(Vec2 centre, double radius, const Stroke& stroke);
  /// The baseline starts, is centred or ends at `at`. Bytes that are not UTF-8 show as '?'.
  void text(Vec2 at, const std::string& words, const TextStyle& style);
  double text_width(const std::string& words, const TextStyle& style);
  void image(const Raster& raster, Vec2 corner);
  /// Everything drawn so far on a PNG canvas, as an image.
  void image(const Canvas& png, Vec2 corner);

  /// The file's bytes; nothing can be drawn afterwards.
  /// Fails: OutOfMemory; InternalDefect with cairo's words.
  Result<std::string> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace planish
