#include "io/feature_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/depth_raster.hpp"
#include "io/feature_lines.hpp"
#include "io/hatching.hpp"
#include "io/page.hpp"

namespace planish {
namespace {

constexpr double kCell = 6;  // pixels
constexpr std::uint8_t kFree = 0, kLine = 1, kLabel = 2;

/// The list, at a width of 1600.
constexpr std::size_t kColumns = 3, kMostListed = 60;
constexpr double kRowHeight = 34, kColumnGap = 48, kSwatch = 44;

std::size_t num_rows(std::size_t num_features) {
  return (std::min(num_features, kMostListed) + kColumns - 1) / kColumns;
}

/// Words with a rim of paper, so that they are read on any ground.
void draw_on_rim(Canvas& canvas, Vec2 at, const std::string& words, const TextStyle& style) {
  constexpr int kDirections = 12;
  TextStyle rim = style;
  rim.colour = kPaper;
  for (int k = 0; k < kDirections; ++k) {
    canvas.text(at + 0.13 * style.size * unit(2 * kPi * k / kDirections), words, rim);
  }
  canvas.text(at, words, style);
}

void draw_swatch(Canvas& canvas, Swatch swatch, std::size_t number, Vec2 left, double unit) {
  const Rgb c = feature_colour(number);
  const double width = kSwatch * unit, half_height = 9 * unit;
  const std::array ends{left, left + Vec2{width, 0}};
  switch (swatch) {
    case Swatch::Line: canvas.polyline(ends, false, {c, 5 * unit, 1}); return;
    case Swatch::DashedLine:
      canvas.polyline(ends, false, {c, 5 * unit, 1});
      draw_ideal(canvas, ends, unit);
      return;
    case Swatch::Tint: {
      constexpr double kGrey = 0.84,
                       kWhite = 1 - kTintShare;  // as on the surface where it is neither dark nor bright
      const Rgb tint{kGrey * (kWhite + kTintShare * c.r), kGrey * (kWhite + kTintShare * c.g),
                     kGrey * (kWhite + kTintShare * c.b)};
      canvas.fill_rectangle(left - Vec2{0, half_height}, {width, 2 * half_height}, tint);
      return;
    }
    case Swatch::Hatching: {
      const std::array box{std::vector<Vec2>{left + Vec2{0, -half_height}, left + Vec2{width, -half_height},
                                             left + Vec2{width, half_height}, left + Vec2{0, half_height}}};
      draw_hatched(canvas, box, number, 0.55 * unit * kHatchSpacing, unit);
      return;
    }
  }
}

void draw_entry(Canvas& canvas, const ListEntry& entry, std::size_t number, Vec2 at, double width,
                double unit) {
  const TextStyle size_style{17 * unit, kPale, false, Anchor::Right};
  const TextStyle name_style{19 * unit, kInk, false, Anchor::Left};
  draw_swatch(canvas, entry.swatch, number, at - Vec2{0, 6 * unit}, unit);
  canvas.text(at + Vec2{width, 0}, entry.size, size_style);
  const double indent = (kSwatch + 14) * unit;
  const double room = width - indent - canvas.text_width(entry.size, size_style) - 14 * unit;
  canvas.text(at + Vec2{indent, 0}, fitting(canvas, entry.name, room, name_style), name_style);
}

}  // namespace

LabelPlacer::LabelPlacer(PixelBox page)
    : page_(page),
      columns_(std::max(1, static_cast<int>(std::ceil((page.upper.x - page.lower.x) / kCell)))),
      rows_(std::max(1, static_cast<int>(std::ceil((page.upper.y - page.lower.y) / kCell)))),
      taken_(static_cast<std::size_t>(columns_) * rows_, kFree) {}

void LabelPlacer::take(const PixelBox& box, std::uint8_t how) {
  const auto cell = [](double x, int n) {
    return std::clamp(static_cast<int>(std::floor(x / kCell)), 0, n - 1);
  };
  const Vec2 low = box.lower - page_.lower, high = box.upper - page_.lower;
  for (int j = cell(low.y, rows_); j <= cell(high.y, rows_); ++j) {
    for (int i = cell(low.x, columns_); i <= cell(high.x, columns_); ++i) {
      auto& taken = taken_[static_cast<std::size_t>(j) * columns_ + i];
      taken = std::max(taken, how);
    }
  }
}

void LabelPlacer::avoid(In<Vec2> line) {
  for (const Vec2 p : line) take({p, p}, kLine);
}

/// Cells on lines; infinite where the box covers a label or leaves the page.
double LabelPlacer::cost(const PixelBox& box) const {
  const Vec2 low = box.lower - page_.lower, high = box.upper - page_.lower;
  if (low.x < 0 || low.y < 0 || box.upper.x > page_.upper.x || box.upper.y > page_.upper.y) return kInfinity;
  int lines = 0;
  for (int j = static_cast<int>(low.y / kCell); j <= std::min(rows_ - 1, static_cast<int>(high.y / kCell));
       ++j) {
    for (int i = static_cast<int>(low.x / kCell);
         i <= std::min(columns_ - 1, static_cast<int>(high.x / kCell)); ++i) {
      const std::uint8_t taken = taken_[static_cast<std::size_t>(j) * columns_ + i];
      if (taken == kLabel) return kInfinity;
      if (taken == kLine) ++lines;
    }
  }
  return lines;
}

void LabelPlacer::place(Canvas& canvas, const std::string& words, In<Vec2> anchors, double size, Rgb colour) {
  const TextStyle style{size, {0.8 * colour.r, 0.8 * colour.g, 0.8 * colour.b}, true, Anchor::Left};
  const double width = canvas.text_width(words, style), away = 0.6 * size;
  constexpr double kWorst = 6;  // cells
  double best = kInfinity;
  PixelBox best_box;
  for (const Vec2 anchor : anchors) {
    // Above, below, right, left of the anchor: the box's upper left corner.
    for (const Vec2 offset :
         {Vec2{-0.5 * width, -away - size}, Vec2{-0.5 * width, away}, Vec2{away, -0.5 * size},
          Vec2{-away - width, -0.5 * size}, Vec2{away, -away - size}, Vec2{-away - width, away}}) {
      const Vec2 corner = anchor + offset;
      const PixelBox box{corner, corner + Vec2{width, size}};
      const double found = cost(box);
      if (found >= best) continue;
      best = found;
      best_box = box;
    }
  }
  if (best > kWorst) return;
  draw_on_rim(canvas, best_box.lower + Vec2{0, 0.82 * size}, words, style);
  take(best_box, kLabel);
}

std::vector<Vec2> anchors_along(In<Vec2> line) {
  std::vector<Vec2> anchors;
  if (line.empty()) return anchors;
  for (const double share : {0.5, 0.35, 0.65, 0.2, 0.8, 0.08, 0.92}) {
    anchors.push_back(line[static_cast<std::size_t>(share * static_cast<double>(line.size() - 1))]);
  }
  return anchors;
}

void place_name(LabelPlacer& placer, Canvas& canvas, const std::string& name, In<Vec2> anchors,
                std::size_t number, double page_width) {
  constexpr double kSize = 21, kSmallest = 9, kWidest = 0.3;
  const double size = std::max(kSmallest, page_width / 1600.0 * kSize);
  const std::string words = fitting(canvas, name, kWidest * page_width, {size, kInk, true, Anchor::Left});
  placer.place(canvas, words, anchors, size, feature_colour(number));
}

std::string size_text(bool is_region, double length, std::size_t num_triangles) {
  if (!is_region) return fmt::format("{:.4g}", length);
  return fmt::format("{} triangle{}", num_triangles, num_triangles == 1 ? "" : "s");
}

double feature_list_height(std::size_t num_features, double unit) {
  const std::size_t lines = num_rows(num_features) + (num_features > kMostListed ? 1 : 0);
  return num_features == 0 ? 0 : unit * (kRowHeight * (static_cast<double>(lines) + 1));
}

void draw_feature_list(Canvas& canvas, const std::vector<ListEntry>& entries, const std::string& note,
                       Vec2 corner, double width, double unit) {
  if (entries.empty()) return;
  const double column = (width - (kColumns - 1) * kColumnGap * unit) / kColumns;
  const std::size_t rows = num_rows(entries.size()), listed = std::min(entries.size(), kMostListed);
  const auto row_of = [&](std::size_t row) {
    return corner.y + unit * kRowHeight * (static_cast<double>(row) + 0.7);
  };
  canvas.text({corner.x, row_of(0)}, "Features", {20 * unit, kInk, true, Anchor::Left});
  canvas.text({corner.x + width, row_of(0)}, note, {16 * unit, kPale, false, Anchor::Right});
  for (std::size_t i = 0; i < listed; ++i) {
    const double x = corner.x + static_cast<double>(i / rows) * (column + kColumnGap * unit);
    draw_entry(canvas, entries[i], i, {x, row_of(i % rows + 1)}, column, unit);
  }
  if (listed == entries.size()) return;
  canvas.text({corner.x, row_of(rows + 1)}, fmt::format("and {} more", entries.size() - listed),
              {17 * unit, kPale, false, Anchor::Left});
}

std::string fitting(Canvas& canvas, std::string words, double width, const TextStyle& style) {
  if (canvas.text_width(words, style) <= width) return words;
  constexpr const char* kEllipsis = "\u2026";
  const auto is_inside_letter = [&] { return (static_cast<unsigned char>(words.back()) & 0xC0) == 0x80; };
  while (!words.empty() && canvas.text_width(words + kEllipsis, style) > width) {
    while (words.size() > 1 && is_inside_letter()) words.pop_back();
    words.pop_back();
  }
  return words + kEllipsis;
}

}  // namespace planish
