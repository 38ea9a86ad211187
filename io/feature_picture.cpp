#include "io/feature_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/feature_labels.hpp"
#include "io/feature_lines.hpp"
#include "io/file.hpp"
#include "io/page.hpp"
#include "io/shaded_surface.hpp"
#include "io/view.hpp"

namespace planish {
namespace {

/// Sizes at a picture of 1600 pixels.
constexpr double kHiddenWidth = 2.6, kDash = 7, kDashGap = 7;
constexpr double kSizeTextSize = 17;

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

std::vector<Index> tint_of_triangles(const std::vector<Feature>& features, Index num_triangles) {
  std::vector<Index> tint;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].is_region()) continue;
    tint.resize(num_triangles, kNone);
    for (const Index t : features[i].triangle) tint[t] = static_cast<Index>(i);
  }
  return tint;
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
  return best == runs.end() ? std::vector<Vec2>{} : anchors_along(best->point);
}

/// The triangle nearest to the middle of those that are seen.
std::vector<Vec2> anchors_in(const Feature& region, const SeenTriangles& triangles,
                             const DepthRaster& surface) {
  std::vector<Vec2> seen;
  Vec2 sum;
  for (const Index t : region.triangle) {
    const auto corner = [&](int i) { return triangles.point[triangles.corner_vertex[3 * t + i]]; };
    const Vec3 p = (1.0 / 3) * (corner(0) + corner(1) + corner(2));
    if (!surface.sees(p, kDepthSlack)) continue;
    seen.push_back({p.x, p.y});
    sum += seen.back();
  }
  if (seen.empty()) return {};
  const Vec2 middle = (1.0 / static_cast<double>(seen.size())) * sum;
  return {*std::ranges::min_element(seen, {}, [&](Vec2 p) { return norm(p - middle); })};
}

DrawnFeature place_feature(const Feature& feature, const SeenTriangles& triangles, const DepthRaster& surface,
                           Vec2 panel_corner) {
  DrawnFeature drawn;
  if (feature.is_region()) {
    drawn.anchors = anchors_in(feature, triangles, surface);
  } else {
    drawn.runs = split_by_sight(surface, triangles.point, feature.vertex, feature.closed, kDepthSlack);
    drawn.anchors = anchors_on(drawn.runs);
  }
  for (LineRun& run : drawn.runs) {
    for (Vec2& p : run.point) p += panel_corner;
  }
  for (Vec2& p : drawn.anchors) p += panel_corner;
  return drawn;
}

/// Hidden runs first, so that no dash lies on a line that is seen.
void draw_chains(Canvas& canvas, const std::vector<DrawnFeature>& drawn, double unit) {
  for (const bool seen : {false, true}) {
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const Rgb colour = feature_colour(i);
      for (const LineRun& run : drawn[i].runs) {
        if (run.seen != seen) continue;
        if (seen) {
          draw_chain(canvas, run.point, false, colour, unit);
        } else {
          draw_dashed(canvas, run.point, unit * kDash, unit * kDashGap, {colour, unit * kHiddenWidth, 0.65});
        }
      }
    }
  }
}

void draw_names(Canvas& canvas, const std::vector<Feature>& features, const std::vector<DrawnFeature>& drawn,
                const Layout& layout) {
  LabelPlacer placer(around_panel(layout.panel_corner, layout.panel_height, layout.width));
  for (const DrawnFeature& feature : drawn) {
    for (const LineRun& run : feature.runs) placer.avoid(run.point);
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    place_name(placer, canvas, features[i].name, drawn[i].anchors, i, layout.width);
  }
}

std::string seen_size(const Box& box, Index num_triangles) {
  const Vec3 size = box.upper - box.lower;
  return fmt::format("{:.4g} \u00d7 {:.4g} as seen, {} triangle{}", size.x, size.y, num_triangles,
                     num_triangles == 1 ? "" : "s");
}

/// The title at the left, its size at the right.
void draw_heading(Canvas& canvas, const Layout& layout, const std::string& title, const std::string& size) {
  const double u = layout.unit;
  const TextStyle size_style{u * kSizeTextSize, kPale, false, Anchor::Right};
  canvas.text({layout.width - u * kMargin, u * kTitleBaseline}, size, size_style);
  const double room = layout.width - 2 * u * kMargin - canvas.text_width(size, size_style) - u * kGap;
  draw_title(canvas, title, room, u);
}

std::vector<Vec3> seen_from(const Exec& exec, const View& view, In<Vec3> position) {
  std::vector<Vec3> point(position.size());
  exec.for_blocks(static_cast<Index>(position.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) point[v] = view.project(position[v]);
  });
  return point;
}

void move_to_panel(const Exec& exec, const Layout& layout, std::vector<Vec3>& point) {
  exec.for_blocks(static_cast<Index>(point.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) point[v] = layout.to_panel(point[v]);
  });
}

void draw_list(Canvas& canvas, const std::vector<Feature>& features, const Layout& layout) {
  std::vector<ListEntry> entries;
  for (const Feature& f : features) {
    entries.push_back({f.name, f.is_region() ? Swatch::Tint : Swatch::Line,
                       size_text(f.is_region(), f.length, f.triangle.size())});
  }
  draw_feature_list(canvas, entries, "lengths in mesh units; dashed: behind the surface",
                    {layout.unit * kMargin, layout.list_top}, layout.width - 2 * layout.unit * kMargin,
                    layout.unit);
}

std::vector<Rgb> colours_of(const std::vector<Feature>& features) {
  std::vector<Rgb> colour;
  for (std::size_t i = 0; i < features.size(); ++i) colour.push_back(feature_colour(i));
  return colour;
}

/// The surface with the features on it, in the panel.
void draw_panel(const Exec& exec, Canvas& canvas, const SeenTriangles& triangles,
                const std::vector<Feature>& features, const Layout& layout) {
  const DepthRaster surface = shade_surface(exec, triangles);
  canvas.image(draw_surface(exec, triangles, surface, layout.unit), layout.panel_corner);
  std::vector<DrawnFeature> drawn;
  for (const Feature& feature : features) {
    drawn.push_back(place_feature(feature, triangles, surface, layout.panel_corner));
  }
  draw_chains(canvas, drawn, layout.unit);
  draw_names(canvas, features, drawn, layout);
}

}  // namespace

Result<void> write_feature_picture(const Exec& exec, const std::string& path, const Surface& surface,
                                   const std::vector<Feature>& features, const PictureOptions& options) {
  const Result<Canvas::Format> format = check_page(path, options.width);
  if (!format) return fail(format.error());
  if (auto checked = check_indices(surface, features); !checked) return fail(checked.error());
  if (auto checked = check_positions(surface, features); !checked) return fail(checked.error());

  std::vector<Vec3> point = seen_from(exec, choose_view(exec, surface), surface.position);
  const Box box = bounding_box(surface, point);
  const Result<Layout> laid_out = lay_out(box, features.size(), options.width);
  if (!laid_out) return fail(laid_out.error());
  const Layout& layout = *laid_out;
  move_to_panel(exec, layout, point);
  const std::vector<Index> tint = tint_of_triangles(features, surface.num_triangles());
  const std::vector<Rgb> tint_colour = colours_of(features);

  Canvas canvas(*format, layout.width, layout.height);
  canvas.fill_rectangle({}, {double(layout.width), double(layout.height)}, kPaper);
  draw_panel(exec, canvas,
             {surface.corner_vertex, point, tint, tint_colour, layout.panel_width, layout.panel_height},
             features, layout);
  draw_heading(canvas, layout, options.title, seen_size(box, surface.num_triangles()));
  draw_list(canvas, features, layout);
  const Result<std::string> bytes = canvas.finish();
  if (!bytes) return fail(bytes.error());
  return write_file(path, *bytes);
}

}  // namespace planish
