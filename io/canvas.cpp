#include "io/canvas.hpp"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace planish {
namespace {

template <auto Release>
struct Releaser {
  template <class T>
  void operator()(T* object) const {
    Release(object);
  }
};
using SurfaceHandle = std::unique_ptr<cairo_surface_t, Releaser<cairo_surface_destroy>>;
using ContextHandle = std::unique_ptr<cairo_t, Releaser<cairo_destroy>>;
using FontOptionsHandle = std::unique_ptr<cairo_font_options_t, Releaser<cairo_font_options_destroy>>;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

SurfaceHandle make_surface(Canvas::Format format, int width, int height, std::string& bytes) {
  if (format == Canvas::Format::Png) {
    return SurfaceHandle(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height));
  }
  SurfaceHandle surface(cairo_svg_surface_create_for_stream(append, &bytes, width, height));
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  return surface;
}

/// Text is placed by unhinted metrics, so that PNG and SVG have the same layout.
void set_font(cairo_t* cr, const TextStyle& style) {
  cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, style.size);
  const FontOptionsHandle options(cairo_font_options_create());
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(cr, options.get());
}

/// The words themselves where they are UTF-8, as cairo demands; else without their foreign bytes.
std::string showable(cairo_t* cr, const std::string& words) {
  cairo_glyph_t* glyphs = nullptr;
  int num_glyphs = 0;
  const cairo_status_t status = cairo_scaled_font_text_to_glyphs(
      cairo_get_scaled_font(cr), 0, 0, words.data(), static_cast<int>(words.size()), &glyphs, &num_glyphs,
      nullptr, nullptr, nullptr);
  cairo_glyph_free(glyphs);
  if (status != CAIRO_STATUS_INVALID_STRING) return words;
  std::string ascii = words;
  std::replace_if(
      ascii.begin(), ascii.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
  return ascii;
}

double advance(cairo_t* cr, const std::string& words) {
  cairo_text_extents_t extents;
  cairo_text_extents(cr, words.c_str(), &extents);
  return extents.x_advance;
}

void copy_rows(const Raster& raster, cairo_surface_t* surface) {
  unsigned char* const target = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  const std::size_t row_bytes = 4 * static_cast<std::size_t>(raster.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(raster.height); ++y) {
    std::memcpy(target + y * stride, raster.pixel.data() + y * raster.width, row_bytes);
  }
  cairo_surface_mark_dirty(surface);
}

void set_colour(cairo_t* cr, Rgb c, double alpha) { cairo_set_source_rgba(cr, c.r, c.g, c.b, alpha); }

}  // namespace

struct Canvas::State {
  State(Format f, int width, int height)
      : format(f), surface(make_surface(f, width, height, bytes)), cr(cairo_create(surface.get())) {
    cairo_set_line_cap(cr.get(), CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cr.get(), CAIRO_LINE_JOIN_ROUND);
  }

  void stroke(const Stroke& s) {
    set_colour(cr.get(), s.colour, s.alpha);
    cairo_set_line_width(cr.get(), s.width);
    cairo_stroke(cr.get());
  }

  std::string bytes;  // before the surface, which writes into it to its end
  Format format;
  SurfaceHandle surface;
  ContextHandle cr;
};

Canvas::Canvas(Format format, int width, int height)
    : state_(std::make_unique<State>(format, width, height)) {}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

Canvas::Format Canvas::format() const { return state_->format; }

void Canvas::fill_rectangle(Vec2 corner, Vec2 size, Rgb colour) {
  cairo_t* const cr = state_->cr.get();
  set_colour(cr, colour, 1);
  cairo_rectangle(cr, corner.x, corner.y, size.x, size.y);
  cairo_fill(cr);
}

void Canvas::polyline(In<Vec2> points, bool closed, const Stroke& stroke) {
  cairo_t* const cr = state_->cr.get();
  for (const Vec2 p : points) cairo_line_to(cr, p.x, p.y);
  if (closed) cairo_close_path(cr);
  state_->stroke(stroke);
}

void Canvas::segments(In<Vec2> points, const Stroke& stroke) {
  // A stroke of all lines at once would have to find the union of their outlines.
  constexpr std::size_t kPointsAStroke = 2000;
  cairo_t* const cr = state_->cr.get();
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    cairo_move_to(cr, points[i].x, points[i].y);
    cairo_line_to(cr, points[i + 1].x, points[i + 1].y);
    if (i % kPointsAStroke == kPointsAStroke - 2) state_->stroke(stroke);
  }
  state_->stroke(stroke);
}

void Canvas::ring(Vec2 centre, double radius, const Stroke& stroke) {
  cairo_t* const cr = state_->cr.get();
  cairo_new_sub_path(cr);
  cairo_arc(cr, centre.x, centre.y, radius, 0, 2 * kPi);
  cairo_close_path(cr);
  state_->stroke(stroke);
}

void Canvas::text(Vec2 at, const std::string& words, const TextStyle& style) {
  cairo_t* const cr = state_->cr.get();
  set_font(cr, style);
  const std::string shown = showable(cr, words);
  const double share = style.anchor == Anchor::Left ? 0 : style.anchor == Anchor::Centre ? 0.5 : 1;
  set_colour(cr, style.colour, 1);
  cairo_move_to(cr, at.x - share * advance(cr, shown), at.y);
  cairo_show_text(cr, shown.c_str());
  cairo_new_path(cr);
}

double Canvas::text_width(const std::string& words, const TextStyle& style) {
  cairo_t* const cr = state_->cr.get();
  set_font(cr, style);
  return advance(cr, showable(cr, words));
}

void Canvas::image(const Raster& raster, Vec2 corner) {
  const SurfaceHandle pixels(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, raster.width, raster.height));
  // Without memory for it, painting it puts our context into the same state.
  if (cairo_surface_status(pixels.get()) == CAIRO_STATUS_SUCCESS) copy_rows(raster, pixels.get());
  cairo_set_source_surface(state_->cr.get(), pixels.get(), corner.x, corner.y);
  cairo_paint(state_->cr.get());
}

void Canvas::image(const Canvas& png, Vec2 corner) {
  cairo_set_source_surface(state_->cr.get(), png.state_->surface.get(), corner.x, corner.y);
  cairo_paint(state_->cr.get());
}

Result<std::string> Canvas::finish() {
  cairo_status_t status = cairo_status(state_->cr.get());
  if (status == CAIRO_STATUS_SUCCESS && state_->format == Format::Png) {
    status = cairo_surface_write_to_png_stream(state_->surface.get(), append, &state_->bytes);
  }
  cairo_surface_finish(state_->surface.get());
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(state_->surface.get());
  if (status == CAIRO_STATUS_NO_MEMORY) return fail(ErrorCode::OutOfMemory, "no memory for the picture");
  if (status != CAIRO_STATUS_SUCCESS) {
    return fail(ErrorCode::InternalDefect, std::string("drawing failed: ") + cairo_status_to_string(status));
  }
  return std::move(state_->bytes);
}

}  // namespace planish
