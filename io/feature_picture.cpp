#include "io/feature_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/feature_labels.hpp"
#include "io/file.hpp"
#include "io/model_panel.hpp"
#include "io/page.hpp"

namespace planish {
namespace {

/// Sizes at a picture of 1600 pixels.
constexpr double kSizeTextSize = 17;

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

/// The surface in true aspect, as wide as fits, the whole at most 4 times as high as wide.
Result<Layout> lay_out(const SeenBox& box, std::size_t num_features, int width) {
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

std::string seen_size(const SeenBox& box, Index num_triangles) {
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

std::vector<PlacedFeature> placed(const std::vector<Feature>& features) {
  std::vector<PlacedFeature> result;
  for (const Feature& f : features)
    result.push_back({f.name, f.vertex, f.closed, f.triangle, PlacedFeature::Ideal::None, f.length});
  return result;
}

}  // namespace

Result<void> write_feature_picture(const Exec& exec, const std::string& path, const Surface& surface,
                                   const std::vector<Feature>& features, const PictureOptions& options) {
  const Result<Canvas::Format> format = check_page(path, options.width);
  if (!format) return fail(format.error());
  const std::vector<PlacedFeature> drawn = placed(features);
  if (auto checked = check_model(surface, drawn); !checked) return fail(checked.error());

  ModelPanel panel;
  panel.corner_vertex = surface.corner_vertex;
  panel.point = seen_from(exec, choose_view(exec, surface), surface.position);
  const SeenBox box = seen_box(surface, panel.point);
  const Result<Layout> laid_out = lay_out(box, features.size(), options.width);
  if (!laid_out) return fail(laid_out.error());
  const Layout& layout = *laid_out;
  move_to_panel(exec, layout, panel.point);
  panel.corner = layout.panel_corner;
  panel.width = layout.panel_width;
  panel.height = layout.panel_height;
  panel.names = around_panel(layout.panel_corner, layout.panel_height, layout.width);
  panel.unit = layout.unit;

  Canvas canvas(*format, layout.width, layout.height);
  canvas.fill_rectangle({}, {double(layout.width), double(layout.height)}, kPaper);
  draw_model(exec, canvas, drawn, panel);
  draw_heading(canvas, layout, options.title, seen_size(box, surface.num_triangles()));
  draw_list(canvas, features, layout);
  const Result<std::string> bytes = canvas.finish();
  if (!bytes) return fail(bytes.error());
  return write_file(path, *bytes);
}

}  // namespace planish
