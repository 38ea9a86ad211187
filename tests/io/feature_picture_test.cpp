#include "io/feature_picture.hpp"

#include <cmath>

#include "io/depth_raster.hpp"
#include "io/feature_labels.hpp"
#include "io/feature_lines.hpp"
#include "io/view.hpp"
#include "tests/io/io_support.hpp"
#include "tests/io/pixels.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using namespace planish::test;

namespace {

Result<void> write(const std::string& path, const Mesh& mesh, const std::vector<Feature>& features,
                   int width = 800, int threads = 0) {
  return write_feature_picture(Exec(threads), path, mesh.surface(), features,
                               {.width = width, .title = "part"});
}

/// Pixels of this colour, above the list of features.
int count(const Pixels& pixels, Rgb colour) {
  return pixels.count(0, pixels.height() - pixels.height() / 6,
                      [&](std::uint32_t p) { return is_colour(p, colour); });
}

/// A flat sheet of 2 n x n cells, twice as wide as high; x y seen from above.
Mesh sheet(Index n, double z = 0) {
  Mesh mesh;
  for (Index j = 0; j <= n; ++j) {
    for (Index i = 0; i <= 2 * n; ++i) mesh.position.push_back({double(i) / n, double(j) / n, z});
  }
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < 2 * n; ++i) {
      const Index a = j * (2 * n + 1) + i, b = a + 2 * n + 1;
      for (const Index v : {a, a + 1, b + 1, a, b + 1, b}) mesh.corner_vertex.push_back(v);
    }
  }
  return mesh;
}

/// Row j of a sheet.
Feature row(Index n, Index j) {
  Feature feature{"row", {}, false, 2, 0, {}};
  for (Index i = 0; i <= 2 * n; ++i) feature.vertex.push_back(j * (2 * n + 1) + i);
  return feature;
}

/// Pixel of a point of the sheet in a picture 800 wide: margin 24, title 29, 376 pixels a unit.
Vec2 on_sheet(double x, double y) { return {24 + 376 * x, 53 + 376 * (1 - y)}; }

bool is_orthonormal(const View& view) {
  const Vec3 off = cross(view.right, view.up) - view.toward;
  return norm(off) < 1e-12 && std::abs(norm(view.toward) - 1) < 1e-12 &&
         std::abs(norm(view.right) - 1) < 1e-12;
}

}  // namespace

TEST_CASE("view: a sheet is seen along its normal, its long side across") {
  for (const double turn : {0.0, 0.3, 1.2, 2.5}) {
    Mesh mesh = sheet(10);
    const Vec2 c = unit(turn);
    for (Vec3& p : mesh.position) p = {c.x * p.x - c.y * p.y, 0, c.y * p.x + c.x * p.y};
    const View view = choose_view(Exec(2), mesh.surface());
    CHECK(is_orthonormal(view));
    CHECK(std::abs(view.toward.y) == doctest::Approx(1));
    CHECK(std::abs(dot(view.right, {c.x, 0, c.y})) == doctest::Approx(1));
    CHECK(std::max(view.up.x, view.up.z) > 0.5);
  }
}

TEST_CASE("view: a closed surface is seen along its least extent") {
  Mesh mesh = shapes::cube(1);
  for (Vec3& p : mesh.position) p = {3 * p.x, 0.5 * p.y, p.z};
  const View view = choose_view(Exec(1), mesh.surface());
  CHECK(view.toward.y == doctest::Approx(1).epsilon(1e-3));
  CHECK(std::abs(view.right.x) == doctest::Approx(1).epsilon(1e-3));
  for (const Mesh& any : {shapes::cube(2), shapes::torus(20), shapes::triangle({}, {}, {}), Mesh{}}) {
    CHECK(is_orthonormal(choose_view(Exec(1), any.surface())));
  }
}

TEST_CASE("depth raster: the nearest triangle is in front, and tells how far it is") {
  const std::vector<Vec3> point = {{0, 0, 5}, {40, 0, 5}, {0, 40, 5}, {0, 0, 0}, {20, 0, 20}, {0, 40, 0}};
  const std::vector<float> grey = {1, 1, 1, 0.5f, 0.5f, 0.5f};
  for (const std::vector<Index>& corners : {std::vector<Index>{0, 1, 2, 3, 4, 5}, {5, 4, 3, 2, 1, 0}}) {
    const DepthRaster r = rasterise_depth(Exec(2), {corners, point, grey, {}, {}}, 40, 40);
    const auto at = [&](int x, int y) { return r.raster.pixel[y * 40 + x] & 0xFF; };
    CHECK(at(2, 2) == 255);   // z = x on the second: behind
    CHECK(at(10, 2) == 128);  // before
    CHECK(at(30, 2) == 255);
    CHECK(at(38, 38) == 0);
    CHECK(r.depth[2 * 40 + 2] == 5);
    CHECK(r.depth[2 * 40 + 10] == doctest::Approx(10.25));  // farthest of the samples at 10.25 and 10.75
    CHECK(r.sees({10.5, 2.5, 10.5}, 1));
    CHECK_FALSE(r.sees({14.5, 2.5, 5}, 1));
    CHECK(r.sees({35, 35, -100}, 0));
  }
}

TEST_CASE("depth raster: a tiling leaves no gaps") {
  Mesh mesh = shapes::height_field(40, shapes::flat, 0.3);
  for (Vec3& p : mesh.position) p = {50 * (p.x + 1), 50 * (p.y + 1), 0};
  const std::vector<float> grey(mesh.position.size(), 1);
  const DepthRaster r = rasterise_depth(Exec(2), {mesh.corner_vertex, mesh.position, grey, {}, {}}, 100, 100);
  CHECK(std::ranges::count(r.raster.pixel, 0xFFFFFFFFu) == 100 * 100);
}

TEST_CASE("feature lines: a chain is cut where a surface hides it") {
  // A wall of height 10 over x in [20, 40]; the chain runs below it at z = 0.
  const std::vector<Vec3> wall = {{20, 0, 10}, {40, 0, 10}, {40, 60, 10}, {20, 60, 10}};
  const std::vector<Index> corners = {0, 1, 2, 0, 2, 3};
  const std::vector<float> grey(4, 1);
  const DepthRaster r = rasterise_depth(Exec(1), {corners, wall, grey, {}, {}}, 60, 60);
  const std::vector<Vec3> point = {{0, 30, 0}, {60, 30, 0}};
  const std::vector<Index> chain = {0, 1};
  const std::vector<LineRun> runs = split_by_sight(r, point, chain, false, 1);
  REQUIRE(runs.size() == 3);
  CHECK(runs[0].seen);
  CHECK_FALSE(runs[1].seen);
  CHECK(runs[2].seen);
  CHECK(runs[1].point.front() == runs[0].point.back());
  CHECK(runs[1].point.front().x == doctest::Approx(21).epsilon(0.1));
  CHECK(runs[2].point.front().x == doctest::Approx(39).epsilon(0.1));
  CHECK(runs[2].point.back() == Vec2{60, 30});
  CHECK(split_by_sight(r, point, chain, true, 1).size() == 5);
  CHECK(split_by_sight(r, point, chain, false, 20).size() == 1);
}

TEST_CASE("feature picture: a PNG has the width asked for and the surface's aspect") {
  const TemporaryFolder folder;
  REQUIRE(write(folder / "p.png", sheet(6), {row(6, 3)}));
  const Pixels pixels(folder / "p.png");
  CHECK(pixels.width() == 800);
  const double list = feature_list_height(1, 0.5);
  CHECK(pixels.height() == static_cast<int>(std::ceil(53 + 376 + 18 + list + 24)));
  REQUIRE(write(folder / "none.png", sheet(6), {}));
  CHECK(Pixels(folder / "none.png").height() == 53 + 376 + 24);
}

TEST_CASE("feature picture: chains have their colours where they project to") {
  const TemporaryFolder folder;
  constexpr Index n = 12;
  REQUIRE(write(folder / "p.png", sheet(n), {row(n, 3), row(n, 9)}));
  const Pixels pixels(folder / "p.png");
  for (double x = 0.05; x < 2; x += 0.1) {
    CHECK(pixels.is(on_sheet(x, 0.25), feature_colour(0)));
    CHECK(pixels.is(on_sheet(x, 0.75), feature_colour(1)));
    CHECK_FALSE(pixels.is(on_sheet(x, 0.5), feature_colour(0)));
  }
}

TEST_CASE("feature picture: a closed chain is drawn around") {
  const TemporaryFolder folder;
  constexpr Index n = 4, w = 2 * n + 1;
  const Feature square{
      "square", {w + 1, w + 2, w + 3, 2 * w + 3, 3 * w + 3, 3 * w + 2, 3 * w + 1, 2 * w + 1}, true, 2, 0, {}};
  Feature open = square;
  open.closed = false;
  REQUIRE(write(folder / "closed.png", sheet(n), {square}));
  REQUIRE(write(folder / "open.png", sheet(n), {open}));
  const Vec2 last_side = on_sheet(0.25, 0.375);
  CHECK(Pixels(folder / "closed.png").is(last_side, feature_colour(0)));
  CHECK_FALSE(Pixels(folder / "open.png").is(last_side, feature_colour(0)));
}

TEST_CASE("feature picture: regions are tinted, and only they") {
  const TemporaryFolder folder;
  Feature region{"plate", {}, false, 0, 0, {}};
  for (Index t = 0; t < 2 * 2 * 2; ++t) region.triangle.push_back(t);  // the lower row of 4 cells
  REQUIRE(write(folder / "p.png", sheet(2), {region}));
  const Pixels pixels(folder / "p.png");
  const auto is_grey = [&](Vec2 p) {
    const std::uint32_t c = pixels.at(static_cast<int>(p.x), static_cast<int>(p.y));
    return (c & 255) == (c >> 8 & 255) && (c & 255) == (c >> 16);
  };
  for (double x = 0.3; x < 2; x += 0.5) {
    CHECK_FALSE(is_grey(on_sheet(x, 0.1)));
    CHECK(is_grey(on_sheet(x, 0.9)));
  }
}

TEST_CASE("feature picture: what lies behind the surface is dashed and fainter") {
  const TemporaryFolder folder;
  constexpr Index n = 12;
  const Mesh seen = shapes::joined(sheet(n, 0), sheet(n, -1)),
             hidden = shapes::joined(sheet(n, 0), sheet(n, 1));
  REQUIRE(write(folder / "seen.png", seen, {row(n, 6)}));
  REQUIRE(write(folder / "hidden.png", hidden, {row(n, 6)}));
  const int full = count(Pixels(folder / "seen.png"), feature_colour(0));
  CHECK(full > 752);
  CHECK(count(Pixels(folder / "hidden.png"), feature_colour(0)) < full / 20);
  CHECK(bytes_of(folder / "hidden.png") != bytes_of(folder / "seen.png"));
}

TEST_CASE("feature picture: an SVG is well-formed, with lines as vectors") {
  const TemporaryFolder folder;
  REQUIRE(write(folder / "p.svg", sheet(8), {row(8, 4)}));
  const std::string svg = bytes_of(folder / "p.svg");
  CHECK(svg.starts_with("<?xml"));
  CHECK(svg.find("<svg") != std::string::npos);
  CHECK(svg.ends_with("</svg>\n"));
  CHECK(svg.find("data:image/png;base64") != std::string::npos);
  CHECK(svg.find("rgb(0%,36%,73%)") != std::string::npos);
  CHECK(std::ranges::count(svg, '<') == std::ranges::count(svg, '>'));
}

TEST_CASE("feature picture: 1, 2 and 7 threads give the same file") {
  const TemporaryFolder folder;
  const Mesh mesh = shapes::wavy_disk(20000);
  const std::vector<Feature> features = {{"chain", {5, 6, 7, 8}, false, 1, 0, {}},
                                         {"plate", {}, false, 0, 0, {9, 10}}};
  REQUIRE(write(folder / "1.png", mesh, features, 400, 1));
  for (const int threads : {2, 7}) {
    REQUIRE(write(folder / "n.png", mesh, features, 400, threads));
    CHECK(bytes_of(folder / "n.png") == bytes_of(folder / "1.png"));
  }
}

TEST_CASE("feature picture: degenerate surfaces, names and many features are drawn without a crash") {
  const TemporaryFolder folder;
  Mesh point = sheet(3), line = sheet(3), high = sheet(3), none, tiny = sheet(3);
  for (Vec3& p : point.position) p = {1, 2, 3};
  for (Vec3& p : line.position) p.y = 0;
  for (Vec3& p : high.position) p.y *= 1e6;
  for (Vec3& p : tiny.position) p = 1e-310 * p;
  for (const Mesh& mesh : {point, line, high, tiny, shapes::moebius(30)}) {
    CHECK(write(folder / "p.png", mesh, {{"a", {0, 1}, true, 0, 0, {}}}, 200));
  }
  CHECK(write(folder / "p.svg", none, {}, 200));
  const std::vector<Feature> odd = {{"\xff\xfe", {0, 1}, false, 1, 0, {}},
                                    {std::string(3000, 'W'), {4, 5}, false, 1, 0, {}},
                                    {"", {}, false, 0, 0, {}}};
  CHECK(write(folder / "odd.svg", sheet(3), odd, 400));
  const std::vector<Feature> many(500, row(3, 1));
  REQUIRE(write(folder / "many.png", sheet(3), many, 400));
  CHECK(Pixels(folder / "many.png").height() <= 1600);
}

TEST_CASE("feature picture: wrong input is refused, with the vertices") {
  const TemporaryFolder folder;
  Mesh mesh = sheet(3);
  const auto code = [&](const std::string& name, const std::vector<Feature>& features, int width = 400) {
    const auto written = write(folder / name, mesh, features, width);
    REQUIRE(!written);
    return written.error().code;
  };
  CHECK(code("p.jpg", {}) == ErrorCode::UnknownFormat);
  CHECK(code("missing/p.png", {}) == ErrorCode::CannotWrite);
  CHECK(code("p.png", {}, 10) == ErrorCode::BadUsage);
  CHECK(code("p.png", {{"a", {0, 28}, false, 1, 0, {}}}) == ErrorCode::IndexOutOfRange);
  CHECK(code("p.png", {{"a", {}, false, 1, 0, {36}}}) == ErrorCode::IndexOutOfRange);
  mesh.position.push_back({kInfinity, 0, 0});  // unreferenced
  CHECK(write(folder / "p.png", mesh, {}));
  CHECK(code("q.png", {{"a", {0, 28}, false, 1, 0, {}}}) == ErrorCode::NonFinitePosition);
  mesh.position[5].y = std::nan("");
  const auto written = write(folder / "q.png", mesh, {});
  REQUIRE(!written);
  CHECK(written.error().ids == std::vector<Index>{5});
  CHECK(folder.names() == std::vector<std::string>{"p.png"});
  mesh = sheet(3);
  mesh.position[0].x = -1.5e308;
  mesh.position[1].x = 1.5e308;
  CHECK(code("q.png", {}) == ErrorCode::NonFinitePosition);
}
