#include "io/flat_features.hpp"

#include "io/feature_lines.hpp"
#include "io/legend.hpp"
#include "io/page.hpp"
#include "io/picture.hpp"
#include "tests/io/io_support.hpp"
#include "tests/io/pixels.hpp"

using namespace planish;
using namespace planish::test;

namespace {

using Ideal = PlacedFeature::Ideal;

/// A sheet of 2 n x n cells, twice as wide as high, that was flat before.
struct FlatSheet {
  Mesh mesh;
  std::vector<Vec2> uv;
  std::vector<PlacedFeature> features = {};
  int width = 1600;

  explicit FlatSheet(Index n) {
    for (Index j = 0; j <= n; ++j) {
      for (Index i = 0; i <= 2 * n; ++i) add({double(i) / n, double(j) / n});
    }
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < 2 * n; ++i) {
        const Index a = j * (2 * n + 1) + i, b = a + 2 * n + 1;
        for (const Index v : {a, a + 1, b + 1, a, b + 1, b}) mesh.corner_vertex.push_back(v);
      }
    }
  }
  Index add(Vec2 p) {
    mesh.position.push_back({p.x, p.y, 0});
    uv.push_back(p);
    return static_cast<Index>(uv.size()) - 1;
  }
  /// A chain of vertices of its own.
  PlacedFeature& chain(const std::vector<Vec2>& point, Ideal ideal = Ideal::None) {
    PlacedFeature& feature = features.emplace_back();
    for (const Vec2 p : point) feature.vertex.push_back(add(p));
    feature.ideal = ideal;
    return feature;
  }
  Result<void> write(const std::string& path, int threads = 0, const Certificate& certificate = {}) const {
    return write_picture(Exec(threads), path, mesh.surface(), uv, certificate,
                         {.width = width, .title = "sheet", .features = features});
  }
};

/// Pixel of a point of the sheet in a picture 1600 wide: margin 48, title 58, 752 pixels a unit.
Vec2 on_sheet(double x, double y) { return {48 + 752 * x, 106 + 752 * (1 - y)}; }
Vec2 on_sheet(Vec2 p) { return on_sheet(p.x, p.y); }
constexpr int kPanelTop = 106, kPanelBottom = 106 + 752;

bool is_dark(std::uint32_t pixel) {
  return (pixel & 255) < 110 && (pixel >> 8 & 255) < 110 && (pixel >> 16) < 110;
}

/// The share of points along a polyline that are dark.
template <class At>
double dark_share(const Pixels& pixels, At&& at) {
  constexpr int kLooks = 400;
  int dark = 0;
  for (int k = 0; k < kLooks; ++k) dark += is_dark(pixels.at(at((k + 0.5) / kLooks))) ? 1 : 0;
  return static_cast<double>(dark) / kLooks;
}

auto between(Vec2 a, Vec2 b) {
  return [=](double s) { return on_sheet(a + s * (b - a)); };
}

std::vector<Vec2> arc(Vec2 centre, double radius, double from, double to) {
  std::vector<Vec2> point;
  for (int k = 0; k <= 20; ++k) point.push_back(centre + radius * unit(from + (to - from) * k / 20));
  return point;
}

}  // namespace

TEST_CASE("flat features: chains have their colours where they lie") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  sheet.chain({{0.1, 0.2}, {1.9, 0.2}});
  sheet.chain({{0.1, 0.3}, {1, 0.8}, {1.9, 0.8}});
  REQUIRE(sheet.write(folder / "p.png"));
  const Pixels pixels(folder / "p.png");
  for (double x = 0.15; x < 1.9; x += 0.1) {
    CHECK(pixels.is(on_sheet(x, 0.2), feature_colour(0)));
    CHECK(pixels.is(on_sheet(x, x < 1 ? 0.3 + (x - 0.1) * 0.5 / 0.9 : 0.8), feature_colour(1)));
    CHECK_FALSE(pixels.is(on_sheet(x, 0.21), feature_colour(0)));
  }
}

TEST_CASE("flat features: a rim of paper parts a chain from dark colours") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  for (Vec3& p : sheet.mesh.position) p = 0.1 * p;  // stretched to ten times: the darkest brown
  sheet.chain({{0.2, 0.4}, {1.8, 0.4}});
  REQUIRE(sheet.write(folder / "p.png"));
  const Pixels pixels(folder / "p.png");
  const Vec2 middle = on_sheet(0.9, 0.4);
  const auto lightness = [&](double off) { return pixels.at(middle + Vec2{0, off}) >> 8 & 255; };
  CHECK(lightness(8) < 80);
  CHECK(lightness(3) > 170);
  CHECK(lightness(-4) > 150);
}

TEST_CASE("flat features: a closed chain is drawn around") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  sheet.chain({{0.5, 0.2}, {0.9, 0.2}, {0.9, 0.9}, {0.5, 0.9}});
  REQUIRE(sheet.write(folder / "open.png"));
  sheet.features[0].closed = true;
  REQUIRE(sheet.write(folder / "closed.png"));
  CHECK_FALSE(Pixels(folder / "open.png").is(on_sheet(0.5, 0.55), feature_colour(0)));
  CHECK(Pixels(folder / "closed.png").is(on_sheet(0.5, 0.55), feature_colour(0)));
}

TEST_CASE("flat features: regions are hatched, and their colours stay readable") {
  const TemporaryFolder folder;
  FlatSheet sheet(2);  // cells of 376 pixels
  PlacedFeature& region = sheet.features.emplace_back();
  region.triangle = {0, 1, 2, 3};  // the lower two cells at the left
  REQUIRE(sheet.write(folder / "p.png"));
  const Pixels pixels(folder / "p.png");
  const Rgb c = feature_colour(0), zero = diverging_colour(0);
  int hatched = 0, untouched = 0, outside = 0, looks = 0;
  for (double x = 0.03; x < 0.97; x += 0.0041) {
    for (double y = 0.03; y < 0.47; y += 0.0043) {
      const auto is_blue = [](std::uint32_t p) { return (p & 255) > (p >> 16) + 90; };
      ++looks;
      hatched += is_blue(pixels.at(on_sheet(x, y)));
      untouched += pixels.is(on_sheet(x, y), zero);
      outside += is_blue(pixels.at(on_sheet(x, y + 0.5))) + is_blue(pixels.at(on_sheet(x + 1, y)));
    }
  }
  CHECK(hatched > 0.05 * looks);
  CHECK(hatched < 0.25 * looks);
  CHECK(untouched > 0.6 * looks);
  CHECK(outside == 0);
  for (double x = 0.03; x < 0.97; x += 0.1) CHECK(pixels.is(on_sheet(x, 0.5), c));  // the border
}

TEST_CASE("flat features: the line nearest to a chain is dashed, and reaches a little beyond its ends") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  std::vector<Vec2> zigzag;
  for (int k = 0; k < 40; ++k) zigzag.push_back({0.5 + k / 39.0, k % 4 % 3 == 0 ? 0.51 : 0.49});
  PlacedFeature& feature = sheet.chain(zigzag, Ideal::Line);
  REQUIRE(sheet.write(folder / "line.png"));
  feature.ideal = Ideal::None;
  REQUIRE(sheet.write(folder / "none.png"));
  const Pixels line(folder / "line.png"), none(folder / "none.png");
  const double reach = 44.0 / 752;
  for (const auto& [from, to] :
       {std::pair(0.5, 1.5), std::pair(0.5 - reach, 0.49), std::pair(1.51, 1.5 + reach)}) {
    const auto along = between({from, 0.5}, {to, 0.5});
    CHECK(dark_share(line, along) > 0.3);
    CHECK(dark_share(line, along) < 0.8);
    CHECK(dark_share(none, along) < 0.1);
  }
  CHECK(dark_share(line, between({0.3, 0.5}, {0.49 - reach, 0.5})) < 0.03);
}

TEST_CASE("flat features: the circle nearest to an arc is dashed all around, with its centre") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  const Vec2 centre{1.1, 0.45};
  PlacedFeature& feature = sheet.chain(arc(centre, 0.3, 0.2, 1.4), Ideal::Circle);
  REQUIRE(sheet.write(folder / "circle.png"));
  feature.ideal = Ideal::None;
  REQUIRE(sheet.write(folder / "none.png"));
  const Pixels circle(folder / "circle.png"), none(folder / "none.png");
  const auto around = [&](double radius) {
    return
        [=](double s) { return on_sheet(centre + radius * unit(1.5 + 4.9 * s)); };  // where the chain is not
  };
  CHECK(dark_share(circle, around(0.3)) > 0.3);
  CHECK(dark_share(circle, around(0.3)) < 0.8);
  CHECK(dark_share(circle, around(0.29)) < 0.05);
  CHECK(dark_share(circle, around(0.31)) < 0.05);
  CHECK(dark_share(none, around(0.3)) < 0.05);
  CHECK(is_dark(circle.at(on_sheet(centre))));
  CHECK(is_dark(circle.at(on_sheet(centre) + Vec2{7, 0})));
  CHECK_FALSE(is_dark(circle.at(on_sheet(centre) + Vec2{14, 0})));
  CHECK_FALSE(is_dark(none.at(on_sheet(centre))));
}

TEST_CASE("flat features: ideal figures stay near the panel") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  sheet.chain(arc({2, 0}, 0.9, 1.7, 3.0), Ideal::Circle);  // three quarters of the circle are outside
  REQUIRE(sheet.write(folder / "p.png"));
  sheet.features.clear();
  REQUIRE(sheet.write(folder / "none.png"));
  const Pixels pixels(folder / "p.png"), none(folder / "none.png");
  int changed = 0;
  for (int y = kPanelBottom + 30; y < none.height() - kMargin; ++y) {
    for (int x = 0; x < none.width(); ++x) changed += pixels.at(x, y) != none.at(x, y) ? 1 : 0;
  }
  CHECK(changed == 0);
}

TEST_CASE("flat features: names stand beside chains and in regions") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  sheet.chain({{0.2, 0.3}, {1.8, 0.3}});
  sheet.features.emplace_back().triangle = {20, 21};
  const auto coloured = [&](std::size_t number, int top, int bottom) {
    REQUIRE(sheet.write(folder / "p.png"));
    const Rgb c = feature_colour(number);
    const Rgb words{0.8 * c.r, 0.8 * c.g, 0.8 * c.b};
    return Pixels(folder / "p.png").count(top, bottom, [&](std::uint32_t p) { return is_colour(p, words); });
  };
  const int line = static_cast<int>(on_sheet(0, 0.3).y);
  CHECK(coloured(0, kPanelTop, kPanelBottom) == 0);
  CHECK(coloured(1, kPanelTop, kPanelBottom) == 0);
  sheet.features[0].name = "roof";
  sheet.features[1].name = "plate";
  CHECK(coloured(0, line - 40, line + 40) > 100);
  CHECK(coloured(1, kPanelTop, kPanelBottom) > 100);
}

TEST_CASE("flat features: the list below has every name, as outlines") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  sheet.chain({{0.2, 0.3}, {1.8, 0.3}}).name = "W";
  const auto num_glyphs = [&] {
    REQUIRE(sheet.write(folder / "p.svg"));
    const std::string svg = bytes_of(folder / "p.svg");
    int n = 0;
    for (auto at = svg.find("<use "); at != std::string::npos; at = svg.find("<use ", at + 1)) ++n;
    return n;
  };
  const int one = num_glyphs();
  sheet.features[0].name = "WWW";
  CHECK(num_glyphs() - one == 2 * (1 + 1 + 12));  // in the list; beside the chain, with 12 for the rim
  const int three = num_glyphs();
  sheet.features[0].length = 1234;
  CHECK(num_glyphs() - three == 3);  // instead of 0
}

TEST_CASE("flat features: the page grows by the list, and is what it was without features") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);
  sheet.chain({{0.2, 0.3}, {1.8, 0.3}});
  REQUIRE(sheet.write(folder / "p.png"));
  sheet.features.clear();
  REQUIRE(sheet.write(folder / "empty.png"));
  REQUIRE(write_picture(Exec(0), folder / "default.png", sheet.mesh.surface(), sheet.uv, {},
                        {.width = 1600, .title = "sheet"}));
  CHECK(bytes_of(folder / "empty.png") == bytes_of(folder / "default.png"));
  const Pixels with(folder / "p.png"), without(folder / "empty.png");
  CHECK(without.height() == kPanelBottom + kGap + kLegendHeight + kMargin);
  CHECK(with.height() == without.height() + kGap / 2 + feature_list_height(1, 1));
  int changed = 0;
  const int chain = static_cast<int>(on_sheet(0, 0.3).y);
  for (int y = 0; y < without.height() - kMargin; ++y) {
    if (std::abs(y - chain) <= 6) continue;
    for (int x = 0; x < without.width(); ++x) changed += with.at(x, y) != without.at(x, y) ? 1 : 0;
  }
  CHECK(changed == 0);
}

TEST_CASE("flat features: flipped triangles are marked above the features") {
  const TemporaryFolder folder;
  FlatSheet sheet(60);
  sheet.chain({{0.2, 0.5}, {1.8, 0.5}});
  Certificate certificate;
  certificate.flipped = {60 * 60 * 2 - 60};  // in the middle of the sheet
  certificate.flipped_triangles = 1;
  REQUIRE(sheet.write(folder / "p.png", 0, certificate));
  const Pixels pixels(folder / "p.png");
  const auto is_flip = [](std::uint32_t p) { return is_colour(p, kFlipColour); };
  const int line = static_cast<int>(on_sheet(0, 0.5).y);
  CHECK(pixels.count(line - 2, line + 2, is_flip) >= 8);
}

TEST_CASE("flat features: 1, 2 and 7 threads give the same file") {
  const TemporaryFolder folder;
  FlatSheet sheet(60);
  sheet.width = 500;
  sheet.chain(arc({1, 0.5}, 0.3, 0, 2), Ideal::Circle).name = "arc";
  sheet.features.emplace_back().triangle = {100, 101, 102, 103};
  REQUIRE(sheet.write(folder / "1.png", 1));
  for (const int threads : {2, 7}) {
    REQUIRE(sheet.write(folder / "n.png", threads));
    CHECK(bytes_of(folder / "n.png") == bytes_of(folder / "1.png"));
  }
}

TEST_CASE("flat features: degenerate panels, features and names are drawn without a crash") {
  const TemporaryFolder folder;
  const auto add_odd_features = [](FlatSheet& sheet) {
    for (const Ideal ideal : {Ideal::None, Ideal::Line, Ideal::Circle}) {
      sheet.features.push_back({"one", {5}, false, {}, ideal, 0});
      sheet.features.push_back({"twice", {5, 5, 5, 5}, true, {}, ideal, 0});
      sheet.features.push_back({"straight", {0, 1, 2, 3}, false, {}, ideal, 0});
      sheet.features.push_back({"bent", {0, 1, 8}, true, {}, ideal, 0});
      sheet.features.push_back({"\xff\xfe", {}, true, {}, ideal, 0});
      sheet.features.push_back({std::string(3000, 'W'), {}, false, {3, 3, 4}, ideal, kInfinity});
    }
  };
  FlatSheet plain(3), point(3), line(3), none(3), tiny(3), high(3);
  for (Vec2& p : point.uv) p = {3, 4};
  for (Vec2& p : line.uv) p.x = 0;
  for (Vec2& p : tiny.uv) p = 1e-310 * p;
  for (Vec2& p : high.uv) p.y *= 1e6;
  for (FlatSheet* sheet : {&plain, &point, &line, &tiny, &high}) {
    add_odd_features(*sheet);
    for (const int width : {200, 800}) {
      sheet->width = width;
      CHECK(sheet->write(folder / "p.png"));
      CHECK(sheet->write(folder / "p.svg"));
      CHECK(Pixels(folder / "p.png").height() <= 4 * width);
    }
  }
  none.mesh.corner_vertex.clear();
  none.chain({{0.1, 0.1}, {0.2, 0.3}, {0.5, 0.1}}, Ideal::Circle);
  CHECK(none.write(folder / "none.png"));
  FlatSheet many(3);
  many.width = 400;
  many.features.assign(500, {"row", {0, 1, 2, 3}, false, {}, Ideal::Line, 1});
  REQUIRE(many.write(folder / "many.png"));
  CHECK(Pixels(folder / "many.png").height() <= 1600);
}

TEST_CASE("flat features: vertices and triangles that do not exist are refused, with the feature's name") {
  const TemporaryFolder folder;
  FlatSheet sheet(3);  // 28 vertices, 36 triangles
  const auto refused = [&](const PlacedFeature& feature) {
    sheet.features = {{"good", {0, 1}, false, {}, Ideal::None, 1}, feature};
    const auto written = sheet.write(folder / "p.png");
    return !written && written.error().code == ErrorCode::IndexOutOfRange &&
           written.error().what.find("'bad'") != std::string::npos;
  };
  CHECK(refused({"bad", {0, 28}, false, {}, Ideal::None, 1}));
  CHECK(refused({"bad", {-1, 0}, false, {}, Ideal::None, 1}));
  CHECK(refused({"bad", {}, false, {36}, Ideal::None, 1}));
  CHECK(refused({"bad", {}, false, {-1}, Ideal::None, 1}));
  CHECK(folder.names().empty());
  CHECK_FALSE(refused({"bad", {27}, false, {}, Ideal::None, 1}));
}
