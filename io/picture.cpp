#include "io/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "io/feature_lines.hpp"
#include "io/file.hpp"
#include "io/flat_features.hpp"
#include "io/legend.hpp"
#include "io/model_panel.hpp"
#include "io/outline.hpp"
#include "io/page.hpp"
#include "io/raster.hpp"
#include "io/stretch_field.hpp"
#include "io/wireframe.hpp"

namespace planish {
namespace {

/// Sizes at a picture of 1600 pixels.
constexpr double kBoundaryWidth = 2.2;
constexpr double kRingRadius = 10, kRingWidth = 2.6;
constexpr double kSmallestMarkUnit = 0.6;  // rings stay visible in small pictures

/// Where everything is, in pixels.
struct Layout {
  int width = 0, height = 0;
  double unit = 1;    ///< width / 1600
  Vec2 panel_corner;  ///< upper left, on whole pixels
  int panel_width = 0, panel_height = 0;
  double pixels_a_unit = 1;  ///< of the mesh
  Vec2 lower;                ///< uv that is drawn at `origin`
  Vec2 origin;               ///< pixels from the panel's corner
  Vec2 size;                 ///< of the panel, mesh units
  double legend_top = 0, list_top = 0;

  /// Pixels from the panel's corner.
  Vec2 to_panel(Vec2 uv) const {
    return {origin.x + pixels_a_unit * (uv.x - lower.x), origin.y - pixels_a_unit * (uv.y - lower.y)};
  }
};

Result<void> check_input(const Surface& surface, In<Vec2> uv, const Certificate& certificate,
                         In<PlacedFeature> features) {
  if (uv.size() != surface.position.size()) {
    return fail(ErrorCode::BadUsage, fmt::format("a picture needs one uv a vertex: {} for {}", uv.size(),
                                                 surface.position.size()));
  }
  const auto out_of = [](Index limit) { return [limit](Index i) { return i < 0 || i >= limit; }; };
  if (std::ranges::any_of(surface.corner_vertex, out_of(surface.num_vertices()))) {
    return fail(ErrorCode::IndexOutOfRange, "a triangle names a vertex that does not exist");
  }
  if (std::ranges::any_of(certificate.flipped, out_of(surface.num_triangles()))) {
    return fail(ErrorCode::IndexOutOfRange, "a flipped triangle does not exist");
  }
  if (auto checked = check_features(features, surface.num_vertices(), surface.num_triangles()); !checked) {
    return checked;
  }
  Error error{
      .code = ErrorCode::NonFinitePosition, .what = "uv is not finite", .element = ElementKind::Vertex};
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    if (std::isfinite(uv[v].x) && std::isfinite(uv[v].y)) continue;
    if (error.ids.size() < kMaxListedIds) error.ids.push_back(v);
    ++error.count;
  }
  if (error.count > 0) return fail(std::move(error));
  return {};
}

/// The panel in true aspect, as wide as fits and never higher than leaves 4 times the width for the whole.
Result<Layout> lay_out(const UvBox& box, std::size_t num_features, int width) {
  Layout layout;
  layout.width = width;
  layout.unit = width / 1600.0;
  layout.lower = box.lower;
  layout.size = box.upper - box.lower;
  if (!std::isfinite(layout.size.x) || !std::isfinite(layout.size.y)) {
    return fail(ErrorCode::NonFinitePosition, "the extent of uv is not finite");
  }
  const double u = layout.unit;
  const double list = num_features > 0 ? 0.5 * u * kGap + feature_list_height(num_features, u) : 0;
  const double around = u * (kMargin + kTitleHeight + kGap + kLegendHeight + kMargin) + list;
  const double room_x = width - 2 * u * kMargin, room_y = 4.0 * width - around - 1;
  const double scale = std::min(room_x / layout.size.x, room_y / layout.size.y);
  layout.pixels_a_unit =
      std::isfinite(scale) ? scale : 1;  // a panel of no size, or as good as none, is a dot
  const double panel_y = std::max(layout.pixels_a_unit * layout.size.y, u * kSmallestPanel);
  layout.panel_corner = {std::floor(u * kMargin), std::floor(u * (kMargin + kTitleHeight))};
  layout.panel_width = static_cast<int>(std::ceil(room_x));
  layout.panel_height = static_cast<int>(std::ceil(panel_y));
  layout.height = static_cast<int>(std::ceil(around + panel_y));
  layout.legend_top = layout.height - u * (kLegendHeight + kMargin) - list;
  layout.list_top = layout.legend_top + u * (kLegendHeight + 0.5 * kGap);
  layout.origin = {0.5 * (room_x - layout.pixels_a_unit * layout.size.x),
                   0.5 * (panel_y + layout.pixels_a_unit * layout.size.y)};
  return layout;
}

/// Pixels from the panel's corner, inside it; unreferenced vertices, which may lie far outside, at its
/// border.
std::vector<Vec2> place_vertices(const Exec& exec, const Layout& layout, In<Vec2> uv) {
  std::vector<Vec2> point(uv.size());
  exec.for_blocks(static_cast<Index>(uv.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      const Vec2 p = layout.to_panel(uv[v]);
      point[v] = {std::clamp(p.x, 0.0, double(layout.panel_width)),
                  std::clamp(p.y, 0.0, double(layout.panel_height))};
    }
  });
  return point;
}

/// Of each triangle, pixels.
std::vector<float> spacing_of_lines(const Exec& exec, In<Vec2> point, In<Index> corner_vertex) {
  std::vector<float> spacing(corner_vertex.size() / 3);
  exec.for_blocks(static_cast<Index>(spacing.size()), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      const auto corner = [&](int i) { return point[corner_vertex[3 * t + i]]; };
      spacing[t] = static_cast<float>(line_spacing(corner(0), corner(1), corner(2)));
    }
  });
  return spacing;
}

Wireframe make_wireframe(const Exec& exec, const Outline& outline, In<Vec2> point, In<Index> corner_vertex) {
  const std::vector<float> spacing = spacing_of_lines(exec, point, corner_vertex);
  Wireframe wireframe({.closest = 4, .full = 12, .alpha = 0.42});
  for (const Index c : outline.inner) {
    const Index twin = outline.twin[c];
    const float closest = twin == kNone ? spacing[c / 3] : std::min(spacing[c / 3], spacing[twin / 3]);
    wireframe.add(point[corner_vertex[c]], point[corner_vertex[next_corner(c)]], closest);
  }
  return wireframe;
}

/// Colours and wireframe; the wireframe as lines where the file stays small.
void draw_field(Canvas& canvas, const Layout& layout, const Raster& raster, Wireframe wireframe) {
  constexpr std::size_t kMostVectorLines = 30000;
  if (canvas.format() == Canvas::Format::Png || wireframe.num_lines() <= kMostVectorLines) {
    canvas.image(raster, layout.panel_corner);
    wireframe.shift(layout.panel_corner);
    wireframe.draw(canvas);
    return;
  }
  Canvas layer(Canvas::Format::Png, layout.panel_width, layout.panel_height);
  layer.image(raster, {});
  wireframe.draw(layer);
  canvas.image(layer, layout.panel_corner);
}

/// Bold, but never more ink than a small part of the panel: a thousand small components keep their colours.
double boundary_width(const std::vector<std::vector<Vec2>>& lines, const Raster& raster, double unit) {
  constexpr double kMostInk = 0.12;
  double length = 0;
  for (const auto& line : lines) {
    for (std::size_t i = 1; i < line.size(); ++i) length += norm(line[i] - line[i - 1]);
  }
  const auto covered = std::ranges::count_if(raster.pixel, [](std::uint32_t p) { return p != 0; });
  if (length == 0 || covered == 0) return unit * kBoundaryWidth;
  return std::clamp(kMostInk * static_cast<double>(covered) / length, 0.35, unit * kBoundaryWidth);
}

void draw_boundary(Canvas& canvas, const Layout& layout, const Outline& outline, In<Vec2> point,
                   const Raster& raster) {
  std::vector<std::vector<Vec2>> lines;
  for (const auto& chain : outline.boundary) lines.push_back(visible_line(chain, point));
  const double width = boundary_width(lines, raster, layout.unit);
  for (auto& line : lines) {
    const bool closed = line.size() > 2 && line.front() == line.back();
    for (Vec2& p : line) p += layout.panel_corner;
    canvas.polyline(line, closed, {kInk, width, 1});
  }
}

/// A ring around every flipped triangle too small to be found by its colour; one for those that stand
/// together.
void mark_flips(Canvas& canvas, const Layout& layout, In<Index> flipped, In<Index> corner_vertex,
                In<Vec2> point) {
  const double unit = std::max(layout.unit, kSmallestMarkUnit);
  const double radius = unit * kRingRadius;
  std::unordered_set<std::int64_t> ringed;
  for (const Index t : flipped) {
    std::array<Vec2, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = point[corner_vertex[3 * t + i]] + layout.panel_corner;
    const double extent = std::max({norm(p[1] - p[0]), norm(p[2] - p[1]), norm(p[0] - p[2])});
    if (extent >= 2 * radius) {
      canvas.polyline(p, true, {kFlipColour, 1.5 * unit, 1});
      continue;
    }
    const Vec2 centre = (1.0 / 3) * (p[0] + p[1] + p[2]);
    const auto cell = [&](double x) { return static_cast<std::int64_t>(x / (1.5 * radius)); };
    if (!ringed.insert(cell(centre.x) << 32 | cell(centre.y)).second) continue;
    canvas.ring(centre, radius, {kPaper, unit * (kRingWidth + 3), 0.85});
    canvas.ring(centre, radius, {kFlipColour, unit * kRingWidth, 1});
  }
}

void draw_captions(Canvas& canvas, const Layout& layout, In<Caption> captions) {
  constexpr double kSize = 20, kLine = 30;
  for (const Caption& caption : captions) {
    Vec2 at = layout.to_panel(caption.top) + layout.panel_corner;
    for (std::size_t i = 0; i < caption.lines.size(); ++i) {
      at.y += layout.unit * (i == 0 ? kSize : kLine);
      canvas.text(at, caption.lines[i], {layout.unit * kSize, i == 0 ? kInk : kPale, i == 0, Anchor::Centre});
    }
  }
}

void draw_seen_model(const Exec& exec, Canvas& canvas, const Layout& layout, const SeenModel& model) {
  const Vec2 from = layout.to_panel({model.lower.x, model.upper.y}) + layout.panel_corner,
             to = layout.to_panel({model.upper.x, model.lower.y}) + layout.panel_corner;
  ModelPanel panel;
  panel.corner_vertex = model.surface.corner_vertex;
  panel.corner = {std::floor(from.x), std::floor(from.y)};
  panel.width = std::max(1, static_cast<int>(std::ceil(to.x - panel.corner.x)));
  panel.height = std::max(1, static_cast<int>(std::ceil(to.y - panel.corner.y)));
  panel.unit = layout.unit;
  const Vec2 aside{0.25 * layout.unit * kMargin, 0.25 * layout.unit * kMargin};
  panel.names = {from - aside, to + aside};
  panel.point = seen_from(exec, model.view, model.surface.position);
  const Vec3 lower = seen_box(model.surface, panel.point).lower;
  exec.for_blocks(static_cast<Index>(panel.point.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      const Vec3 q = layout.pixels_a_unit * (panel.point[v] - lower);
      panel.point[v] = {std::clamp(from.x - panel.corner.x + q.x, 0.0, double(panel.width)),
                        std::clamp(to.y - panel.corner.y - q.y, 0.0, double(panel.height)), q.z};
    }
  });
  draw_model(exec, canvas, model.features, panel);
}

}  // namespace

UvBox UvBox::with(In<Index> corner_vertex, In<Vec2> uv) const {
  UvBox box = *this;
  for (const Index v : corner_vertex) {
    box.lower = {std::min(box.lower.x, uv[v].x), std::min(box.lower.y, uv[v].y)};
    box.upper = {std::max(box.upper.x, uv[v].x), std::max(box.upper.y, uv[v].y)};
  }
  return box;
}

Result<void> write_picture(const Exec& exec, const std::string& path, const Surface& surface, In<Vec2> uv,
                           const Certificate& certificate, const PictureOptions& options) {
  const Result<Canvas::Format> format = check_page(path, options.width);
  if (!format) return fail(format.error());
  if (auto checked = check_input(surface, uv, certificate, options.features); !checked)
    return fail(checked.error());
  for (const auto& copy : options.copies) {
    auto checked = check_features(copy, surface.num_vertices(), surface.num_triangles());
    if (!checked) return checked;
  }
  if (options.model) {
    if (auto checked = check_model(options.model->surface, options.model->features); !checked) return checked;
  }
  const UvBox panel = UvBox().with(surface.corner_vertex, uv);
  UvBox box = options.window.value_or(UvBox()).with(surface.corner_vertex, uv);
  if (surface.num_triangles() == 0 && !options.window) box = {{}, {}};
  const Result<Layout> laid_out = lay_out(box, options.features.size(), options.width);
  if (!laid_out) return fail(laid_out.error());
  const Layout& layout = *laid_out;
  const In<Index> corner_vertex = surface.corner_vertex;

  const std::vector<Vec2> point = place_vertices(exec, layout, uv);
  const StretchField field = stretch_field(exec, surface, uv, certificate.flipped);
  const Raster raster =
      rasterise(exec, corner_vertex, point, field.value, layout.panel_width, layout.panel_height);
  const Outline outline = find_outline(exec, corner_vertex, surface.num_vertices());

  Canvas canvas(*format, layout.width, layout.height);
  canvas.fill_rectangle({}, {double(layout.width), double(layout.height)}, kPaper);
  draw_field(canvas, layout, raster, make_wireframe(exec, outline, point, corner_vertex));
  draw_boundary(canvas, layout, outline, point, raster);
  if (options.model) draw_seen_model(exec, canvas, layout, *options.model);
  const FlatPanel flat{corner_vertex,       point,        layout.panel_corner,
                       layout.panel_height, layout.width, options.named};
  for (const auto& copy : options.copies) draw_features(exec, canvas, copy, flat);
  draw_features(exec, canvas, options.features, flat);
  mark_flips(canvas, layout, certificate.flipped, corner_vertex, point);
  draw_captions(canvas, layout, options.captions);
  draw_title(canvas, options.title, layout.width - 2 * layout.unit * kMargin, layout.unit);
  const PanelFigures figures = options.figures.value_or(
      PanelFigures{surface.num_triangles(), options.window ? panel.upper - panel.lower : layout.size});
  draw_legend(canvas,
              {.limit = field.limit,
               .certificate = figures.measured ? &certificate : nullptr,
               .triangles = figures.triangles,
               .panel_size = figures.size,
               .pixels_a_unit = layout.pixels_a_unit},
              layout.legend_top, layout.unit * kMargin, layout.unit);
  draw_list_of(canvas, options.features, {layout.unit * kMargin, layout.list_top},
               layout.width - 2 * layout.unit * kMargin, layout.unit);
  const Result<std::string> bytes = canvas.finish();
  if (!bytes) return fail(bytes.error());
  return write_file(path, *bytes);
}

}  // namespace planish
