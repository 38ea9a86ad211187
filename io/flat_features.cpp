#include "io/flat_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "io/feature_lines.hpp"
#include "io/hatching.hpp"
#include "io/ideal_figures.hpp"
#include "io/outline.hpp"
#include "io/page.hpp"

namespace planish {
namespace {

/// Sizes at a picture of 1600 pixels.
constexpr double kBeyond = 44, kCross = 9, kRim = 4.2;
constexpr double kSmallestUnit = 0.5;  // lines stay coloured in small pictures
constexpr double kStep = 3;            // pixels between points that a name shall not cover

/// The line or the circle that a chain was to become, cut to what the page shows.
struct IdealFigure {
  std::vector<std::vector<Vec2>> lines;
  std::optional<Vec2> centre;  ///< of a circle
};

/// A feature on the page.
struct DrawnFeature {
  std::vector<Vec2> line;                ///< of a chain
  std::vector<std::vector<Vec2>> loops;  ///< borders of a region
  IdealFigure ideal;
  std::vector<Vec2> anchors;  ///< where its name may stand, the best places first
};

bool contains(const PixelBox& box, Vec2 p) {
  return p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y && p.y <= box.upper.y;
}

IdealFigure ideal_figure(PlacedFeature::Ideal ideal, In<Vec2> point, const PixelBox& box, double unit) {
  IdealFigure figure;
  if (ideal == PlacedFeature::Ideal::Line) {
    const auto line = fit_line(point);
    if (line) figure.lines.push_back(part_inside(*line, unit * kBeyond, box));
  } else if (ideal == PlacedFeature::Ideal::Circle) {
    const auto circle = fit_circle(point);
    if (!circle) return figure;
    figure.lines = parts_inside(*circle, 1, box);
    if (contains(box, circle->centre)) figure.centre = circle->centre;
  }
  std::erase_if(figure.lines, [](const auto& line) { return line.size() < 2; });
  return figure;
}

/// Of a closed line the uppermost point first, then the lowest, the rightmost and the leftmost.
std::vector<Vec2> anchors_on(In<Vec2> line, bool closed) {
  std::vector<Vec2> anchors;
  if (closed) {
    const auto [left, right] = std::ranges::minmax_element(line, {}, &Vec2::x);
    const auto [top, bottom] = std::ranges::minmax_element(line, {}, &Vec2::y);
    anchors = {*top, *bottom, *right, *left};
  }
  const std::vector<Vec2> along = anchors_along(line);
  anchors.insert(anchors.end(), along.begin(), along.end());
  return anchors;
}

DrawnFeature place_chain(const PlacedFeature& chain, const FlatPanel& panel) {
  DrawnFeature drawn;
  drawn.line = visible_line(chain.vertex, panel.point);
  for (Vec2& p : drawn.line) p += panel.corner;
  std::vector<Vec2> point;
  for (const Index v : chain.vertex) point.push_back(panel.point[v] + panel.corner);
  const PixelBox box = around_panel(panel.corner, panel.height, panel.page_width);
  drawn.ideal = ideal_figure(chain.ideal, point, box, panel.unit());
  drawn.anchors = anchors_on(subdivided(drawn.line, chain.closed, kStep), chain.closed);
  return drawn;
}

/// The border of a region, found in a mesh of its own.
std::vector<std::vector<Vec2>> border_of(const Exec& exec, In<Index> triangle, const FlatPanel& panel) {
  std::vector<Index> corner;
  for (const Index t : triangle) {
    for (int i = 0; i < 3; ++i) corner.push_back(panel.corner_vertex[3 * t + i]);
  }
  std::vector<Index> vertex = corner;
  std::ranges::sort(vertex);
  vertex.erase(std::ranges::unique(vertex).begin(), vertex.end());
  for (Index& v : corner) v = static_cast<Index>(std::ranges::lower_bound(vertex, v) - vertex.begin());
  std::vector<Vec2> point;
  for (const Index v : vertex) point.push_back(panel.point[v] + panel.corner);

  std::vector<std::vector<Vec2>> loops;
  const Outline outline = find_outline(exec, corner, static_cast<Index>(vertex.size()));
  for (const auto& chain : outline.boundary) loops.push_back(visible_line(chain, point));
  return loops;
}

/// The middle of the triangle nearest to the middle of all.
std::vector<Vec2> anchors_in(In<Index> triangle, const FlatPanel& panel) {
  if (triangle.empty()) return {};
  std::vector<Vec2> middle;
  Vec2 sum;
  for (const Index t : triangle) {
    const auto corner = [&](int i) { return panel.point[panel.corner_vertex[3 * t + i]]; };
    middle.push_back(panel.corner + (1.0 / 3) * (corner(0) + corner(1) + corner(2)));
    sum += middle.back();
  }
  const Vec2 mean = (1 / static_cast<double>(middle.size())) * sum;
  return {*std::ranges::min_element(middle, {}, [&](Vec2 p) { return norm(p - mean); })};
}

DrawnFeature place_feature(const Exec& exec, const PlacedFeature& feature, const FlatPanel& panel) {
  if (!feature.is_region()) return place_chain(feature, panel);
  DrawnFeature drawn;
  drawn.loops = border_of(exec, feature.triangle, panel);
  drawn.anchors = anchors_in(feature.triangle, panel);
  return drawn;
}

std::array<std::array<Vec2, 2>, 2> cross_at(Vec2 centre, double size) {
  return {
      {{centre - Vec2{size, 0}, centre + Vec2{size, 0}}, {centre - Vec2{0, size}, centre + Vec2{0, size}}}};
}

/// What makes ideal figures readable on any ground, below the chains.
void draw_rims(Canvas& canvas, const std::vector<DrawnFeature>& drawn, double unit) {
  const Stroke rim{kPaper, unit * kRim, 0.65};
  for (const DrawnFeature& feature : drawn) {
    for (const auto& line : feature.ideal.lines) canvas.polyline(line, false, rim);
    if (!feature.ideal.centre) continue;
    for (const auto& arm : cross_at(*feature.ideal.centre, unit * kCross)) canvas.polyline(arm, false, rim);
  }
}

void draw_ideals(Canvas& canvas, const std::vector<DrawnFeature>& drawn, double unit) {
  const Stroke ink{kInk, unit * kIdealWidth, 1};
  for (const DrawnFeature& feature : drawn) {
    for (const auto& line : feature.ideal.lines) draw_ideal(canvas, line, unit);
    if (!feature.ideal.centre) continue;
    for (const auto& arm : cross_at(*feature.ideal.centre, unit * kCross)) canvas.polyline(arm, false, ink);
  }
}

void draw_names(Canvas& canvas, In<PlacedFeature> features, const std::vector<DrawnFeature>& drawn,
                const FlatPanel& panel) {
  LabelPlacer placer(around_panel(panel.corner, panel.height, panel.page_width));
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (!drawn[i].line.empty()) placer.avoid(subdivided(drawn[i].line, features[i].closed, kStep));
    for (const auto& line : drawn[i].ideal.lines) placer.avoid(subdivided(line, false, kStep));
  }
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (features[i].name.empty()) continue;
    place_name(placer, canvas, features[i].name, drawn[i].anchors, i, panel.page_width);
  }
}

}  // namespace

Result<void> check_features(In<PlacedFeature> features, Index num_vertices, Index num_triangles) {
  const auto out_of = [](Index limit) { return [limit](Index i) { return i < 0 || i >= limit; }; };
  for (const PlacedFeature& feature : features) {
    if (std::ranges::any_of(feature.vertex, out_of(num_vertices)) ||
        std::ranges::any_of(feature.triangle, out_of(num_triangles))) {
      return fail(ErrorCode::IndexOutOfRange,
                  "the feature '" + feature.name + "' names a vertex or a triangle that does not exist");
    }
  }
  return {};
}

void draw_features(const Exec& exec, Canvas& canvas, In<PlacedFeature> features, const FlatPanel& panel) {
  const double unit = std::max(kSmallestUnit, panel.unit());
  std::vector<DrawnFeature> drawn;
  for (const PlacedFeature& feature : features) drawn.push_back(place_feature(exec, feature, panel));
  for (std::size_t i = 0; i < drawn.size(); ++i)
    draw_hatched(canvas, drawn[i].loops, i, std::max(6.0, unit * kHatchSpacing), unit);
  draw_rims(canvas, drawn, unit);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (!drawn[i].line.empty())
      draw_chain(canvas, drawn[i].line, features[i].closed, feature_colour(i), unit);
  }
  draw_ideals(canvas, drawn, unit);
  if (panel.named) draw_names(canvas, features, drawn, panel);
}

void draw_list_of(Canvas& canvas, In<PlacedFeature> features, Vec2 corner, double width, double unit) {
  using Ideal = PlacedFeature::Ideal;
  std::vector<ListEntry> entries;
  for (const PlacedFeature& f : features) {
    const bool dashed = !f.is_region() && f.ideal != Ideal::None;
    entries.push_back({f.name,
                       f.is_region() ? Swatch::Hatching
                       : dashed      ? Swatch::DashedLine
                                     : Swatch::Line,
                       size_text(f.is_region(), f.length, f.triangle.size())});
  }
  const bool any = std::ranges::count(entries, Swatch::DashedLine, &ListEntry::swatch) > 0;
  const char* const note =
      any ? "lengths in mesh units; dashed: the nearest line or circle" : "lengths in mesh units";
  draw_feature_list(canvas, entries, note, corner, width, unit);
}

}  // namespace planish
