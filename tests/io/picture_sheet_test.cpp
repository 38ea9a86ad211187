#include "io/picture_sheet.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>

#include "io/feature_lines.hpp"
#include "kernels/intrinsic/transport.hpp"

#include "tests/io/pixels.hpp"

namespace planish {
namespace {

using test::Pixels;

/// A square of edge 1, and maps of it of other sizes.
struct Sheet {
  Sheet() {
    for (const double size : {1.5, 0.5, 1.5}) {
      std::vector<Vec2> map;
      for (const Vec3 p : position) map.push_back({size * p.x + 7, size * p.y - 3});
      uv.push_back(map);
    }
    for (const auto& map : uv) maps.push_back({.uv = map, .certificate = &certificate});
    std::filesystem::remove(path);
  }
  ~Sheet() { std::filesystem::remove(path); }
  Result<void> write(const std::optional<SheetModel>& model = {}) const {
    return write_picture_sheet(Exec(1), path, {position, corner_vertex}, maps,
                               {.width = 800, .title = "sheet"}, model);
  }

  std::vector<Vec3> position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<Index> corner_vertex = {0, 1, 2, 0, 2, 3};
  std::vector<std::vector<Vec2>> uv;
  Certificate certificate;
  std::vector<SheetMap> maps;
  std::string path =
      (std::filesystem::temp_directory_path() / ("planish_sheet" + std::to_string(getpid()) + ".png"))
          .string();
};

/// Pixels of a colour, the legend's left out.
int area_of(const Pixels& pixels, double value) {
  const int legend = static_cast<int>(250 * pixels.width() / 1600.0);
  return pixels.count(0, pixels.height() - legend,
                      [&](std::uint32_t p) { return test::is_colour(p, diverging_colour(value)); });
}

TEST_CASE("picture sheet: all maps have one scale, whatever their sizes and places") {
  const Sheet sheet;
  REQUIRE(sheet.write());
  const Pixels pixels(sheet.path);
  CHECK(area_of(pixels, 1) == doctest::Approx(18 * area_of(pixels, -1)).epsilon(0.1));
}

TEST_CASE("picture sheet: maps with captions stand in rows, and captions need room") {
  Sheet sheet;
  REQUIRE(sheet.write());
  const Pixels in_one_row(sheet.path);
  const int largest = area_of(in_one_row, 1);
  sheet.maps.push_back(sheet.maps[1]);
  for (SheetMap& map : sheet.maps) map.caption = {"a map", "and a line"};
  REQUIRE(sheet.write());
  const Pixels in_rows(sheet.path);
  CHECK(in_rows.height() > in_one_row.height());
  CHECK(area_of(in_rows, 1) > 1.5 * largest);  // two columns in place of four
}

int coloured(const Pixels& pixels, Rgb colour) {
  return pixels.count(0, pixels.height() - 130, [&](std::uint32_t p) { return test::is_colour(p, colour); });
}

TEST_CASE("picture sheet: the model has its features in the colours that they have on every map") {
  Sheet sheet;
  const std::vector<PlacedFeature> features = {
      {"side", {0, 1}, false, {}, PlacedFeature::Ideal::None, 1},
      {"diagonal", {0, 2}, false, {}, PlacedFeature::Ideal::None, 1}};
  for (SheetMap& map : sheet.maps) map.features = features;
  REQUIRE(sheet.write());
  const Pixels alone(sheet.path);
  REQUIRE(sheet.write(SheetModel{{"model"}}));
  const Pixels with_model(sheet.path);
  CHECK(with_model.height() != alone.height());
  // A length of 1 beside 1.5 + 0.5 + 1.5, in four columns of 1.5 in place of three.
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    CAPTURE(k);
    const int maps_alone = coloured(alone, feature_colour(k));
    CHECK(maps_alone > 0);
    CHECK(coloured(with_model, feature_colour(k)) > 1.1 * 0.75 * maps_alone);
  }
  sheet.position[1].z = kInfinity;
  CHECK(sheet.write(SheetModel{}).error().code == ErrorCode::NonFinitePosition);
}

TEST_CASE("picture sheet: beside a model, maps are turned to lie as it is seen") {
  Sheet sheet;
  for (Vec3& p : sheet.position) p.x *= 3;
  std::vector<int> height;
  std::vector<int> neutral;
  for (const double angle : {0.0, 1.3}) {
    std::vector<Vec2> map;
    const Vec2 turn = unit(angle);
    for (const Vec3 p : sheet.position)
      map.push_back({turn.x * p.x - turn.y * p.y, turn.y * p.x + turn.x * p.y});
    sheet.maps = {{.uv = map, .certificate = &sheet.certificate}};
    REQUIRE(sheet.write(SheetModel{{"model"}}));
    height.push_back(Pixels(sheet.path).height());
    neutral.push_back(area_of(Pixels(sheet.path), 0));
    REQUIRE(sheet.write());
    height.push_back(Pixels(sheet.path).height());
  }
  CHECK(height[0] == height[2]);
  CHECK(height[1] != height[3]);
  CHECK(neutral[0] == doctest::Approx(neutral[1]).epsilon(0.02));
  CHECK(neutral[0] > 0);
}

TEST_CASE("picture sheet: no maps, and maps of another number of uv, are refused and write nothing") {
  Sheet sheet;
  sheet.maps[1].uv = sheet.maps[1].uv.first(3);
  CHECK(sheet.write().error().code == ErrorCode::BadUsage);
  sheet.maps.clear();
  CHECK(sheet.write().error().code == ErrorCode::BadUsage);
  CHECK_FALSE(std::filesystem::exists(sheet.path));
}

}  // namespace
}  // namespace planish
