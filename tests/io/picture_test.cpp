#include "io/picture.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/colour_scale.hpp"
#include "io/legend.hpp"
#include "tests/io/pixels.hpp"

namespace planish {
namespace {

using test::bytes_of;
using test::Pixels;

/// A folder that is gone after the test.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / (name + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

struct Panel {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex;
  std::vector<Vec2> uv;
  Certificate certificate = {};
  PictureOptions options = {.width = 400, .title = "panel"};

  Result<void> write(const std::string& path, int threads = 0) const {
    return write_picture(Exec(threads), path, {position, corner_vertex}, uv, certificate, options);
  }
};

/// n x m cells of a wavy sheet of width 2 and height 2 m / n, dropped onto the plane.
Panel wavy_panel(int n, int m) {
  Panel panel;
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n, y = 2.0 * j / n;
      panel.position.push_back({x, y, 0.1 * std::sin(5 * x) * std::cos(3 * y)});
      panel.uv.push_back({x, y});
    }
  }
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      panel.corner_vertex.insert(panel.corner_vertex.end(), {a, b, d, a, d, c});
    }
  }
  return panel;
}

/// Pixels above the legend's place that hold.
template <class Holds>
int count(const Pixels& pixels, Holds&& holds) {
  const int last = pixels.height() - static_cast<int>((kLegendHeight + 48) * pixels.width() / 1600.0);
  return pixels.count(pixels.width() * 100 / 1600, last, holds);
}

/// Magenta, thinned at most to half by antialiasing: no colour of the scale, of paper or of ink is near.
bool is_flip_colour(std::uint32_t pixel) {
  const int r = pixel >> 16 & 255, g = pixel >> 8 & 255, b = pixel & 255;
  return r - g > 110 && b - g > 50;
}
bool is_drawn(std::uint32_t pixel) { return pixel != 0xFFFFFF; }

TEST_CASE("picture: a PNG has the width asked for and the panel's aspect") {
  const Folder folder("planish_picture_size");
  const auto height_of = [&](int m) {
    Panel panel = wavy_panel(20, m);
    panel.options.width = 800;
    REQUIRE(panel.write(folder.file("p.png")));
    const Pixels pixels(folder.file("p.png"));
    CHECK(pixels.width() == 800);
    return pixels.height();
  };
  const int low = height_of(10), high = height_of(20);
  CHECK(std::abs(high - low - 752 / 2) <= 1);  // 752: the panel's width between the margins
}

TEST_CASE("picture: a high panel is at most 4 times as high as wide") {
  const Folder folder("planish_picture_high");
  REQUIRE(wavy_panel(2, 200).write(folder.file("p.png")));
  const Pixels pixels(folder.file("p.png"));
  CHECK(pixels.height() <= 4 * 400);
  CHECK(pixels.height() > 1500);
}

TEST_CASE("picture: 1, 2 and 7 threads give the same file") {
  const Folder folder("planish_picture_threads");
  const Panel panel = wavy_panel(300, 150);
  REQUIRE(panel.write(folder.file("1.png"), 1));
  for (const int threads : {2, 7}) {
    REQUIRE(panel.write(folder.file("n.png"), threads));
    CHECK(bytes_of(folder.file("n.png")) == bytes_of(folder.file("1.png")));
  }
}

TEST_CASE("picture: a single flipped triangle far below a pixel is ringed") {
  const Folder folder("planish_picture_flip");
  Panel panel = wavy_panel(600, 300);
  REQUIRE(panel.write(folder.file("none.png")));
  CHECK(count(Pixels(folder.file("none.png")), is_flip_colour) == 0);
  panel.certificate.flipped = {123457};
  panel.certificate.flipped_triangles = 1;
  REQUIRE(panel.write(folder.file("one.png")));
  CHECK(count(Pixels(folder.file("one.png")), is_flip_colour) > 6);
}

TEST_CASE("picture: a large flipped triangle is filled") {
  const Folder folder("planish_picture_large_flip");
  Panel panel = wavy_panel(4, 2);
  panel.certificate.flipped = {5};
  panel.certificate.flipped_triangles = 1;
  REQUIRE(panel.write(folder.file("p.png")));
  CHECK(count(Pixels(folder.file("p.png")), is_flip_colour) >
        0.6 * 0.5 * 94 * 94);  // half a cell of 94 pixels
}

TEST_CASE("picture: unreferenced vertices do not widen the frame") {
  const Folder folder("planish_picture_unreferenced");
  Panel panel = wavy_panel(8, 4);
  for (Vec2& p : panel.uv) p += Vec2{1000, -2000};
  REQUIRE(panel.write(folder.file("before.png")));
  panel.position.push_back({0, 0, 0});
  panel.uv.push_back({0, 0});
  REQUIRE(panel.write(folder.file("after.png")));
  CHECK(bytes_of(folder.file("before.png")) == bytes_of(folder.file("after.png")));
}

TEST_CASE("picture: the wireframe is left out before it would be grey") {
  const Folder folder("planish_picture_wire");
  const auto flat_panel = [](int n) {
    Panel panel = wavy_panel(n, n / 2);
    for (Vec3& p : panel.position) p.z = 0;
    return panel;
  };
  const auto is_zero_stretch = [](std::uint32_t p) {
    return p == (premultiplied(diverging_colour(0), 1) & 0xFFFFFF);
  };
  const auto share = [&](int n) {
    REQUIRE(flat_panel(n).write(folder.file("p.png")));
    const Pixels pixels(folder.file("p.png"));
    return static_cast<double>(count(pixels, is_zero_stretch)) / count(pixels, is_drawn);
  };
  CHECK(share(400) > 0.95);  // less than a pixel an edge: nothing but the boundary
  CHECK(share(30) < 0.9);    // 12 pixels an edge
  CHECK(share(30) > 0.4);
}

/// Paths of an SVG begin with "M "; the base64 of an image has no blanks.
int num_subpaths(const std::string& svg) {
  int n = 0;
  for (std::size_t at = svg.find("M "); at != std::string::npos; at = svg.find("M ", at + 1)) ++n;
  return n;
}

TEST_CASE(
    "picture: an SVG has the lines of a sparse panel as vectors, and those of a dense one in its image") {
  const Folder folder("planish_picture_svg");
  const auto written = [&](int n) {
    Panel panel = wavy_panel(n, n / 2);
    panel.options.width = 1600;
    REQUIRE(panel.write(folder.file("p.svg")));
    return bytes_of(folder.file("p.svg"));
  };
  const std::string sparse = written(40), dense = written(220), denser = written(600);
  for (const std::string& svg : {sparse, dense, denser}) {
    CHECK(svg.find("<svg") != std::string::npos);
    CHECK(svg.find("data:image/png;base64") != std::string::npos);
  }
  CHECK(num_subpaths(sparse) - num_subpaths(denser) > 2200);  // 2340 inner edges
  CHECK(num_subpaths(dense) < num_subpaths(denser) + 100);    // 72380 inner edges, 7 pixels long
  CHECK(denser.size() < 2000000);
}

TEST_CASE("picture: degenerate panels are drawn without a crash") {
  const Folder folder("planish_picture_degenerate");
  Panel point = wavy_panel(5, 5);
  for (Vec2& p : point.uv) p = {3, 4};
  CHECK(point.write(folder.file("point.png")));
  Panel line = wavy_panel(5, 5);
  for (Vec2& p : line.uv) p.x = 0;
  CHECK(line.write(folder.file("line.svg")));
  Panel one = wavy_panel(1, 1);
  one.corner_vertex.resize(3);
  CHECK(one.write(folder.file("one.png")));
  Panel none = wavy_panel(1, 1);
  none.corner_vertex.clear();
  CHECK(none.write(folder.file("none.png")));
  Panel tiny = wavy_panel(5, 5);
  for (Vec2& p : tiny.uv) p = 1e-310 * p;
  CHECK(tiny.write(folder.file("tiny.png")));
  Panel collapsed = wavy_panel(5, 5);
  for (Vec3& p : collapsed.position) p = {};
  CHECK(collapsed.write(folder.file("collapsed.png")));
}

TEST_CASE("picture: values that are not finite are refused, with their vertices") {
  const Folder folder("planish_picture_nan");
  Panel panel = wavy_panel(5, 5);
  panel.uv[7].x = std::nan("");
  panel.uv[9].y = kInfinity;
  const auto written = panel.write(folder.file("p.png"));
  REQUIRE(!written);
  CHECK(written.error().code == ErrorCode::NonFinitePosition);
  CHECK(written.error().ids == std::vector<Index>{7, 9});
  CHECK(written.error().count == 2);
  CHECK(!std::filesystem::exists(folder.file("p.png")));
  Panel endless = wavy_panel(5, 5);
  endless.uv[0].x = -1.5e308;
  endless.uv[1].x = 1.5e308;
  CHECK(endless.write(folder.file("p.png")).error().code == ErrorCode::NonFinitePosition);
}

TEST_CASE("picture: wrong names, widths and indices are refused") {
  const Folder folder("planish_picture_wrong");
  Panel panel = wavy_panel(5, 5);
  CHECK(panel.write(folder.file("p.jpg")).error().code == ErrorCode::UnknownFormat);
  CHECK(panel.write(folder.file("missing/p.png")).error().code == ErrorCode::CannotWrite);
  panel.certificate.flipped = {50};
  CHECK(panel.write(folder.file("p.png")).error().code == ErrorCode::IndexOutOfRange);
  panel.certificate.flipped = {};
  panel.options.width = 10;
  CHECK(panel.write(folder.file("p.png")).error().code == ErrorCode::BadUsage);
  panel.options.width = 400;
  panel.uv.pop_back();
  CHECK(panel.write(folder.file("p.png")).error().code == ErrorCode::BadUsage);
}

TEST_CASE("picture: titles may be long, empty or not UTF-8") {
  const Folder folder("planish_picture_title");
  Panel panel = wavy_panel(5, 5);
  for (const std::string& title : {std::string(), std::string("\xff\xfe\x80"), std::string(3000, 'W'),
                                   std::string("T\xc3\xbcr ") + std::string(300, 'x') + "\xc3"}) {
    panel.options.title = title;
    CHECK(panel.write(folder.file("p.png")));
    CHECK(panel.write(folder.file("p.svg")));
  }
}

TEST_CASE("legend: scale bars have round lengths") {
  CHECK(round_down(0.9) == doctest::Approx(0.5));
  CHECK(round_down(1) == doctest::Approx(1));
  CHECK(round_down(4.99) == doctest::Approx(2));
  CHECK(round_down(7300) == doctest::Approx(5000));
}

}  // namespace
}  // namespace planish
