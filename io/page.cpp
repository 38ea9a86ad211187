#include "io/page.hpp"

#include <fmt/format.h>

#include "io/feature_labels.hpp"
#include "io/file.hpp"

namespace planish {

Result<Canvas::Format> check_page(const std::string& path, int width) {
  const std::string format = format_of(path);
  if (format != "png" && format != "svg") {
    return fail(
        {.code = ErrorCode::UnknownFormat, .what = "a picture is .svg or .png", .place = {.file = path}});
  }
  if (width < 200 || width > 8000) {
    return fail(ErrorCode::BadUsage, fmt::format("a picture is 200 to 8000 pixels wide, not {}", width));
  }
  return format == "png" ? Canvas::Format::Png : Canvas::Format::Svg;
}

PixelBox around_panel(Vec2 panel_corner, int panel_height, int width) {
  const double unit = width / 1600.0, aside = 0.25 * panel_corner.x;
  return {{aside, panel_corner.y - unit * 14},
          {width - aside, panel_corner.y + panel_height + unit * (kGap - 8)}};
}

void draw_title(Canvas& canvas, const std::string& title, double room, double unit) {
  const TextStyle style{unit * kTitleSize, kInk, true, Anchor::Left};
  canvas.text({unit * kMargin, unit * kTitleBaseline}, fitting(canvas, title, room, style), style);
}

}  // namespace planish
