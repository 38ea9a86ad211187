#include "io/legend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace planish {
namespace {

constexpr Rgb kInk{0.13, 0.13, 0.14};
constexpr Rgb kPale{0.42, 0.42, 0.45};

/// Columns of the strip at a width of 1600: colour scale, figures, size.
constexpr double kScaleWidth = 540;
constexpr double kFiguresLeft = 640, kFiguresRight = 1150;
constexpr double kSizeLeft = 1250;

/// Coordinates of the strip: pixels of a picture of 1600, from its upper left corner.
struct Pen {
  Canvas& canvas;
  double left, top, unit;

  Vec2 at(double x, double y) const { return {left + unit * x, top + unit * y}; }
  void text(double x, double y, const std::string& words, TextStyle style) const {
    style.size *= unit;
    canvas.text(at(x, y), words, style);
  }
  void rectangle(double x, double y, double width, double height, Rgb colour) const {
    canvas.fill_rectangle(at(x, y), {unit * width, unit * height}, colour);
  }
  void line(double x0, double y0, double x1, double y1, double width) const {
    const std::array ends{at(x0, y0), at(x1, y1)};
    canvas.polyline(ends, false, {kInk, unit * width, 1});
  }
};

const std::string kMinus = "\u2212";

std::string number(double x) {
  if (std::isinf(x)) return x > 0 ? "\u221e" : kMinus + "\u221e";
  if (std::isnan(x)) return "undefined";
  std::string text = fmt::format("{:.4g}", std::abs(x));
  return x < 0 ? kMinus + text : text;
}

std::string with_thousands(Offset count) {
  std::string digits = std::to_string(count);
  for (auto i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3) digits.insert(i, ",");
  return digits;
}

std::string percent(double fraction) {
  const std::string sign = fraction > 0 ? "+" : fraction < 0 ? kMinus : "";
  return fmt::format("{}{:.3g}\u2009%", sign, 100 * std::abs(fraction));
}

void draw_scale(const Pen& pen, double limit) {
  constexpr double kTop = 40, kHeight = 26;
  constexpr int kSteps = 270;
  constexpr double kStep = kScaleWidth / kSteps;
  pen.text(0, 22, "Stretch", {20, kInk, true, Anchor::Left});
  pen.text(kScaleWidth, 22, "the principal stretch farther from 1", {16, kPale, false, Anchor::Right});
  for (int k = 0; k < kSteps; ++k) {
    const double overlap = k + 1 < kSteps ? 0.5 : 0;  // no hairlines between neighbours
    pen.rectangle(k * kStep, kTop, kStep + overlap, kHeight, diverging_colour(2.0 * k / (kSteps - 1) - 1));
  }
  constexpr double kBottom = kTop + kHeight;
  for (const double x : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    const double place = 0.5 * (x + 1) * kScaleWidth;
    const Anchor anchor = x == -1 ? Anchor::Left : x == 1 ? Anchor::Right : Anchor::Centre;
    pen.line(place, kBottom, place, kBottom + 6, 1.2);
    pen.text(place, kBottom + 27, percent(x * limit), {18, kInk, false, anchor});
  }
  pen.text(0, kBottom + 52, "compressed", {16, kPale, false, Anchor::Left});
  pen.text(kScaleWidth, kBottom + 52, "stretched", {16, kPale, false, Anchor::Right});
}

void draw_row(const Pen& pen, double y, const std::string& label, const std::string& value, Rgb colour) {
  pen.text(kFiguresLeft, y, label, {18, kPale, false, Anchor::Left});
  pen.text(kFiguresRight, y, value, {18, colour, false, Anchor::Right});
}

/// A stretch, to 4 decimals where that tells it: 0.9998 rather than 1.
std::string stretch(double sigma) {
  const double size = std::abs(sigma);
  return size >= 1e-3 && size < 100 ? (sigma < 0 ? kMinus : "") + fmt::format("{:.4f}", size) : number(sigma);
}

std::string span(const Spread& spread) { return stretch(spread.min) + " \u2026 " + stretch(spread.max); }

/// The ring that marks flipped triangles on the panel, beside their number.
void draw_flip_sign(const Pen& pen, double y) {
  constexpr double kRadius = 7;
  pen.canvas.ring(pen.at(kFiguresLeft - 16, y), kRadius * pen.unit, {kFlipColour, 2.2 * pen.unit, 1});
}

void draw_figures(const Pen& pen, const Certificate& c) {
  draw_row(pen, 22, "larger stretch \u03c3 max", span(c.sigma_max), kInk);
  draw_row(pen, 50, "smaller stretch \u03c3 min", span(c.sigma_min), kInk);
  draw_row(pen, 78, "ARAP energy", number(c.arap), kInk);
  draw_row(pen, 106, "symmetric Dirichlet energy", number(c.symmetric_dirichlet), kInk);
  if (c.flipped_triangles > 0) draw_flip_sign(pen, 128);
  draw_row(pen, 134, "flipped triangles", with_thousands(c.flipped_triangles),
           c.flipped_triangles > 0 ? kFlipColour : kInk);
  draw_row(pen, 162, "overwound vertices, overlapping pairs",
           with_thousands(c.overwound_vertices) + ", " + with_thousands(c.overlapping_pairs),
           c.overwound_vertices + c.overlapping_pairs > 0 ? kFlipColour : kInk);
}

void draw_scale_bar(const Pen& pen, double pixels_a_unit, double panel_width) {
  constexpr double kWidest = 254, kY = 140, kTick = 7;
  const double widest = std::min(kWidest * pen.unit / pixels_a_unit, panel_width);
  if (!(widest > 0) || !std::isfinite(widest)) return;  // a panel without extent has no scale
  const double length = round_down(widest);
  const double drawn = length * pixels_a_unit / pen.unit;
  pen.line(kSizeLeft, kY, kSizeLeft + drawn, kY, 2.4);
  pen.line(kSizeLeft, kY - kTick, kSizeLeft, kY + kTick, 2.4);
  pen.line(kSizeLeft + drawn, kY - kTick, kSizeLeft + drawn, kY + kTick, 2.4);
  pen.text(kSizeLeft, kY - 16, number(length) + (length == 1 ? " mesh unit" : " mesh units"),
           {18, kInk, false, Anchor::Left});
}

void draw_size(const Pen& pen, const Legend& legend) {
  pen.text(kSizeLeft, 22, number(legend.panel_size.x) + " \u00d7 " + number(legend.panel_size.y),
           {20, kInk, true, Anchor::Left});
  pen.text(kSizeLeft, 50, "size in mesh units", {16, kPale, false, Anchor::Left});
  pen.text(kSizeLeft, 78,
           with_thousands(legend.triangles) + (legend.triangles == 1 ? " triangle" : " triangles"),
           {18, kInk, false, Anchor::Left});
  draw_scale_bar(pen, legend.pixels_a_unit, legend.panel_size.x);
}

}  // namespace

double round_down(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  const double lead = x / power;
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

void draw_legend(Canvas& canvas, const Legend& legend, double top, double margin, double unit) {
  const Pen pen{canvas, margin, top, unit};
  draw_scale(pen, legend.limit);
  if (legend.certificate != nullptr) draw_figures(pen, *legend.certificate);
  draw_size(pen, legend);
}

}  // namespace planish
