#include "io/feature_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/canvas.hpp"
#include "io/depth_raster.hpp"
#include "io/feature_labels.hpp"
#include "io/feature_lines.hpp"
#include "io/file.hpp"
#include "io/outline.hpp"
#include "io/view.hpp"

namespace planish {
namespace {

constexpr Rgb kInk{0.13, 0.13, 0.14};
constexpr Rgb kPale{0.42, 0.42, 0.45};
constexpr Rgb kPaper{1, 1, 1};

/// Sizes at a picture of 1600 pixels; all but the wireframe scale with the width.
constexpr double kMargin = 48, kTitleSize = 30, kTitleHeight = 58, kGap = 36, kSmallestPanel = 80;
constexpr double kChainWidth = 5, kRimWidth = 8, kHiddenWidth = 2.6, kDash = 7, kDashGap = 7;
constexpr double kBoundaryWidth = 1.6, kLabelSize = 21;

struct Box {
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
};

/// Where everything is, in pixels.
struct Layout {
  int width = 0, height = 0;
  double unit = 1;    ///< width / 1600
  Vec2 panel_corner;  ///< upper left, on whole pixels
  int panel_width = 0, panel_height = 0;
  double pixels_a_unit = 1;  ///< of the mesh
  Vec3 lower;                ///< point of the view that is drawn at `origin`
  Vec2 origin;               ///< pixels from the panel's corner
  double list_top = 0;

  /// From the panel's corner; z towards the viewer.
  Vec3 to_panel(Vec3 p) const {
    const Vec3 q = pixels_a_unit * (p - lower);
    return {std::clamp(origin.x + q.x, 0.0, double(panel_width)),
            std::clamp(origin.y - q.y, 0.0, double(panel_height)), q.z};
  }
};

Result<void> check_indices(const Surface& surface, const std::vector<Feature>& features) {
  const auto out_of = [](Index limit) { return [limit](Index i) { return i < 0 || i >= limit; }; };
  if (std::ranges::any_of(surface.corner_vertex, out_of(surface.num_vertices()))) {
    return fail(ErrorCode::IndexOutOfRange, "a triangle names a vertex that does not exist");
  }
  for (const Feature& feature : features) {
    if (std::ranges::any_of(feature.vertex, out_of(surface.num_vertices())) ||
        std::ranges::any_of(feature.triangle, out_of(surface.num_triangles()))) {
      return fail(ErrorCode::IndexOutOfRange,
                  "the feature '" + feature.name + "' names a vertex or a triangle that does not exist");
    }
  }
  return {};
}

/// Vertices that are drawn must be finite; others may be anything.
Result<void> check_positions(const Surface& surface, const std::vector<Feature>& features) {
  std::vector<std::uint8_t> used(surface.position.size(), 0);
  for (const Index v : surface.corner_vertex) used[v] = 1;
  for (const Feature& feature : features) {
    for (const Index v : feature.vertex) used[v] = 1;
  }
  Error error{.code = ErrorCode::NonFinitePosition,
              .what = "a position is not finite",
              .element = ElementKind::Vertex};
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    const Vec3 p = surface.position[v];
    if (used[v] == 0 || (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) continue;
    if (error.ids.size() < kMaxListedIds) error.ids.push_back(v);
    ++error.count;
  }
  if (error.count > 0) return fail(std::move(error));
  return {};
}

Box bounding_box(const Surface& surface, In<Vec3> point) {
  Box box;
  for (const Index v : surface.corner_vertex) {
    const Vec3 p = point[v];
    box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
    box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
  }
  if (surface.corner_vertex.empty()) box = {{}, {}};
  return box;
}

/// The surface in true aspect, as wide as fits, the whole at most 4 times as high as wide.
Result<Layout> lay_out(const Box& box, std::size_t num_features, int width) {
  Layout layout;
  layout.width = width;
  layout.unit = width / 1600.0;
  layout.lower = box.lower;
  const Vec3 size = box.upper - box.lower;
  if (!std::isfinite(size.x + size.y + size.z)) {
    return fail(ErrorCode::NonFinitePosition, "the extent of the surface is not finite");
  }
  const double u = layout.unit, list = feature_list_height(num_features, u);
  const double above = u * (kMargin + kTitleHeight), below = (list > 0 ? u * kGap + list : 0) + u * kMargin;
  const double room_x = width - 2 * u * kMargin, room_y = 4.0 * width - above - below - 1;
  const double scale = std::min(room_x / size.x, room_y / size.y);
  layout.pixels_a_unit = std::isfinite(scale) ? scale : 1;  // without size, or as good as none: a dot
  const double panel_y = std::max(layout.pixels_a_unit * size.y, u * kSmallestPanel);
  layout.panel_corner = {std::floor(u * kMargin), std::floor(above)};
  layout.panel_width = static_cast<int>(std::ceil(room_x));
  layout.panel_height = static_cast<int>(std::ceil(panel_y));
  layout.height = static_cast<int>(std::ceil(above + panel_y + below));
  layout.list_top = layout.height - u * kMargin - list;
  layout.origin = {0.5 * (room_x - layout.pixels_a_unit * size.x),
                   0.5 * (panel_y + layout.pixels_a_unit * size.y)};
  return layout;
}

/// Light from the upper left on the side that is seen, in [0, 1] before contrast.
///   point [V] pixels, y down
std::vector<float> shade(const Exec& exec, In<Index> corner_vertex, In<Vec3> point) {
  std::vector<Vec3> normal(point.size());
  for (std::size_t c = 0; c < corner_vertex.size(); c += 3) {
    const Vec3 a = point[corner_vertex[c]], b = point[corner_vertex[c + 1]], d = point[corner_vertex[c + 2]];
    const Vec3 n = cross(b - a, d - a);
    for (int i = 0; i < 3; ++i) normal[corner_vertex[c + i]] = normal[corner_vertex[c + i]] + n;
  }
  const Vec3 light = (1 / norm(Vec3{-0.45, -0.55, 0.7})) * Vec3{-0.45, -0.55, 0.7};
  std::vector<float> grey(point.size());
  exec.for_blocks(static_cast<Index>(point.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      const double size = normal[v].z < 0 ? -norm(normal[v]) : norm(normal[v]);
      grey[v] = size != 0 ? static_cast<float>(0.5 + 0.5 * dot(normal[v], light) / size) : 0.5f;
    }
  });
  return grey;
}

/// Spreads the greys of a nearly flat surface, so that its shape shows; light grey is their middle.
void add_contrast(std::vector<float>& grey, In<Index> corner_vertex) {
  constexpr float kMiddle = 0.84f, kDarkest = 0.42f, kBrightest = 0.97f;
  constexpr float kSpread = 0.26f, kLeastGain = 0.6f, kMostGain = 6;
  constexpr std::size_t kMostLooks = 100000;
  std::vector<float> sorted;
  const std::size_t stride = std::max<std::size_t>(1, corner_vertex.size() / kMostLooks);
  for (std::size_t c = 0; c < corner_vertex.size(); c += stride) sorted.push_back(grey[corner_vertex[c]]);
  if (sorted.empty()) return;
  std::ranges::sort(sorted);
  const auto percentile = [&](std::size_t p) { return sorted[p * (sorted.size() - 1) / 100]; };
  const float middle = percentile(50), spread = percentile(95) - percentile(5);
  const float gain = std::clamp(kSpread / std::max(spread, 1e-6f), kLeastGain, kMostGain);
  for (float& g : grey) g = std::clamp(kMiddle + gain * (g - middle), kDarkest, kBrightest);
}

std::vector<Index> tint_of_triangles(const std::vector<Feature>& features, Index num_triangles) {
  std::vector<Index> tint;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].is_region()) continue;
    tint.resize(num_triangles, kNone);
    for (const Index t : features[i].triangle) tint[t] = static_cast<Index>(i);
  }
  return tint;
}

Vec2 flat(Vec3 p) { return {p.x, p.y}; }

/// Lines by their opacity: they fade as they come closer, and are left out before they would merge into grey.
constexpr int kWireClasses = 8;
constexpr double kClosestLines = 5, kFullLines = 20, kWireAlpha = 0.3;

/// Height of a triangle over its longest edge, pixels.
double spacing(In<Index> corner_vertex, In<Vec3> point, Index t) {
  const auto p = [&](int i) { return flat(point[corner_vertex[3 * t + i]]); };
  const double longest = std::max({norm(p(1) - p(0)), norm(p(2) - p(1)), norm(p(0) - p(2))});
  return longest > 0 ? std::abs(cross(p(1) - p(0), p(2) - p(0))) / longest : 0;
}

/// Inner edges that are seen from end to end.
void draw_wireframe(Canvas& layer, const Outline& outline, const DepthRaster& surface,
                    In<Index> corner_vertex, In<Vec3> point, double slack) {
  std::array<std::vector<Vec2>, kWireClasses> segments;
  for (const Index c : outline.inner) {
    const Vec3 a = point[corner_vertex[c]], b = point[corner_vertex[next_corner(c)]];
    if (norm(flat(b) - flat(a)) < kClosestLines) continue;
    const Index twin = outline.twin[c];
    const double own = spacing(corner_vertex, point, c / 3);
    const double closest = twin == kNone ? own : std::min(own, spacing(corner_vertex, point, twin / 3));
    if (closest < kClosestLines) continue;
    if (!surface.sees(a, slack) || !surface.sees(0.5 * (a + b), slack) || !surface.sees(b, slack)) continue;
    const double strength = std::min((closest - kClosestLines) / (kFullLines - kClosestLines), 0.999);
    auto& list = segments[static_cast<int>(strength * kWireClasses)];
    list.push_back(flat(a));
    list.push_back(flat(b));
  }
  for (int k = 0; k < kWireClasses; ++k) {
    layer.segments(segments[k], {kInk, 0.7, kWireAlpha * (k + 0.5) / kWireClasses});
  }
}

void draw_boundary(Canvas& layer, const Outline& outline, const DepthRaster& surface, In<Vec3> point,
                   double slack, double unit) {
  for (const auto& chain : outline.boundary) {
    for (const LineRun& run : split_by_sight(surface, point, chain, false, slack)) {
      if (run.seen) layer.polyline(run.point, false, {kInk, std::max(0.6, unit * kBoundaryWidth), 0.8});
    }
  }
}

/// The surface without its features, as large as the panel.
Canvas draw_surface(const Exec& exec, const Layout& layout, const DepthRaster& surface,
                    In<Index> corner_vertex, In<Vec3> point, double slack) {
  Canvas layer(Canvas::Format::Png, layout.panel_width, layout.panel_height);
  layer.image(surface.raster, {});
  const Outline outline = find_outline(exec, corner_vertex, static_cast<Index>(point.size()));
  draw_wireframe(layer, outline, surface, corner_vertex, point, slack);
  draw_boundary(layer, outline, surface, point, slack, layout.unit);
  return layer;
}

/// A feature on the page: its runs (chains) and where its name may stand, the best places first.
struct DrawnFeature {
  std::vector<LineRun> runs;
  std::vector<Vec2> anchors;
};

/// Places along the longest seen run; along the longest of all where none is seen.
std::vector<Vec2> anchors_on(const std::vector<LineRun>& runs) {
  const auto rank = [](const LineRun& run) { return std::pair(run.seen, run.point.size()); };
  const auto best = std::ranges::max_element(runs, {}, rank);
  if (best == runs.end()) return {};
  std::vector<Vec2> anchors;
  for (const double share : {0.5, 0.35, 0.65, 0.2, 0.8, 0.08, 0.92}) {
    anchors.push_back(
        best->point[static_cast<std::size_t>(share * static_cast<double>(best->point.size() - 1))]);
  }
  return anchors;
}

/// The triangle nearest to the middle of those that are seen.
std::vector<Vec2> anchors_in(const Feature& region, In<Index> corner_vertex, In<Vec3> point,
                             const DepthRaster& surface, double slack) {
  std::vector<Vec2> seen;
  Vec2 sum;
  for (const Index t : region.triangle) {
    const Vec3 p = (1.0 / 3) * (point[corner_vertex[3 * t]] + point[corner_vertex[3 * t + 1]] +
                                point[corner_vertex[3 * t + 2]]);
    if (!surface.sees(p, slack)) continue;
    seen.push_back(flat(p));
    sum += flat(p);
  }
  if (seen.empty()) return {};
  const Vec2 middle = (1.0 / static_cast<double>(seen.size())) * sum;
  return {*std::ranges::min_element(seen, {}, [&](Vec2 p) { return norm(p - middle); })};
}

DrawnFeature place_feature(const Feature& feature, In<Index> corner_vertex, In<Vec3> point,
                           const DepthRaster& surface, const Layout& layout, double slack) {
  DrawnFeature drawn;
  if (feature.is_region()) {
    drawn.anchors = anchors_in(feature, corner_vertex, point, surface, slack);
  } else {
    drawn.runs = split_by_sight(surface, point, feature.vertex, feature.closed, slack);
    drawn.anchors = anchors_on(drawn.runs);
  }
  for (LineRun& run : drawn.runs) {
    for (Vec2& p : run.point) p += layout.panel_corner;
  }
  for (Vec2& p : drawn.anchors) p += layout.panel_corner;
  return drawn;
}

/// Hidden runs first, so that no dash lies on a line that is seen.
void draw_chains(Canvas& canvas, const std::vector<DrawnFeature>& drawn, double unit) {
  for (const bool seen : {false, true}) {
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const Rgb colour = feature_colour(i);
      for (const LineRun& run : drawn[i].runs) {
        if (run.seen != seen) continue;
        if (!seen) {
          draw_dashed(canvas, run.point, unit * kDash, unit * kDashGap, {colour, unit * kHiddenWidth, 0.65});
          continue;
        }
        canvas.polyline(run.point, false, {kPaper, unit * kRimWidth, 0.75});
        canvas.polyline(run.point, false, {colour, unit * kChainWidth, 1});
      }
    }
  }
}

void draw_names(Canvas& canvas, const std::vector<Feature>& features, const std::vector<DrawnFeature>& drawn,
                const Layout& layout) {
  const double u = layout.unit;
  const Vec2 corner = layout.panel_corner;
  LabelPlacer placer({{0.25 * corner.x, corner.y - u * 14},
                      {layout.width - 0.25 * corner.x, corner.y + layout.panel_height + u * (kGap - 8)}});
  for (const DrawnFeature& feature : drawn) {
    for (const LineRun& run : feature.runs) placer.avoid(run.point);
  }
  constexpr double kSmallestLabel = 9, kWidestLabel = 0.3;
  const double size = std::max(kSmallestLabel, u * kLabelSize);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const std::string name =
        fitting(canvas, features[i].name, kWidestLabel * layout.width, {size, kInk, true, Anchor::Left});
    placer.place(canvas, name, drawn[i].anchors, size, feature_colour(i));
  }
}

std::string size_text(const Box& box, Index num_triangles) {
  const Vec3 size = box.upper - box.lower;
  return fmt::format("{:.4g} \u00d7 {:.4g} as seen, {} triangle{}", size.x, size.y, num_triangles,
                     num_triangles == 1 ? "" : "s");
}

void draw_title(Canvas& canvas, const Layout& layout, const std::string& title, const std::string& size) {
  const double u = layout.unit, baseline = u * (kMargin + 0.8 * kTitleSize);
  const TextStyle style{u * kTitleSize, kInk, true, Anchor::Left};
  const TextStyle size_style{u * 17, kPale, false, Anchor::Right};
  canvas.text({layout.width - u * kMargin, baseline}, size, size_style);
  const double room = layout.width - 2 * u * kMargin - canvas.text_width(size, size_style) - u * kGap;
  canvas.text({u * kMargin, baseline}, fitting(canvas, title, room, style), style);
}

std::vector<Vec3> seen_from(const Exec& exec, const View& view, In<Vec3> position) {
  std::vector<Vec3> point(position.size());
  exec.for_blocks(static_cast<Index>(position.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) point[v] = view.project(position[v]);
  });
  return point;
}

}  // namespace

Result<void> write_feature_picture(const Exec& exec, const std::string& path, const Surface& surface,
                                   const std::vector<Feature>& features, const PictureOptions& options) {
  const std::string format = format_of(path);
  if (format != "png" && format != "svg") {
    return fail(
        {.code = ErrorCode::UnknownFormat, .what = "a picture is .svg or .png", .place = {.file = path}});
  }
  if (options.width < 200 || options.width > 8000) {
    return fail(ErrorCode::BadUsage,
                fmt::format("a picture is 200 to 8000 pixels wide, not {}", options.width));
  }
  if (auto checked = check_indices(surface, features); !checked) return fail(checked.error());
  if (auto checked = check_positions(surface, features); !checked) return fail(checked.error());

  std::vector<Vec3> point = seen_from(exec, choose_view(exec, surface), surface.position);
  const Box box = bounding_box(surface, point);
  const Result<Layout> laid_out = lay_out(box, features.size(), options.width);
  if (!laid_out) return fail(laid_out.error());
  const Layout& layout = *laid_out;
  exec.for_blocks(static_cast<Index>(point.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) point[v] = layout.to_panel(point[v]);
  });

  const In<Index> corner_vertex = surface.corner_vertex;
  std::vector<float> grey = shade(exec, corner_vertex, point);
  add_contrast(grey, corner_vertex);
  const std::vector<Index> tint = tint_of_triangles(features, surface.num_triangles());
  std::vector<Rgb> colour;
  for (std::size_t i = 0; i < features.size(); ++i) colour.push_back(feature_colour(i));
  const DepthRaster depth = rasterise_depth(exec, {corner_vertex, point, grey, tint, colour},
                                            layout.panel_width, layout.panel_height);
  constexpr double kSlack = 1.5;  // pixels of depth by which what is seen may lie behind
  std::vector<DrawnFeature> drawn;
  for (const Feature& feature : features) {
    drawn.push_back(place_feature(feature, corner_vertex, point, depth, layout, kSlack));
  }

  Canvas canvas(format == "png" ? Canvas::Format::Png : Canvas::Format::Svg, layout.width, layout.height);
  canvas.fill_rectangle({}, {double(layout.width), double(layout.height)}, kPaper);
  canvas.image(draw_surface(exec, layout, depth, corner_vertex, point, kSlack), layout.panel_corner);
  draw_chains(canvas, drawn, layout.unit);
  draw_names(canvas, features, drawn, layout);
  draw_title(canvas, layout, options.title, size_text(box, surface.num_triangles()));
  draw_feature_list(canvas, features, {layout.unit * kMargin, layout.list_top},
                    layout.width - 2 * layout.unit * kMargin, layout.unit);
  auto bytes = canvas.finish();
  if (!bytes) return fail(bytes.error());
  return write_file(path, *bytes);
}

}  // namespace planish
