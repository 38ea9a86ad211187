#include "io/picture_sheet.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>

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
  Result<void> write() const {
    return write_picture_sheet(Exec(1), path, {position, corner_vertex}, maps,
                               {.width = 800, .title = "sheet"});
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
  for (SheetMap& map : sheet.maps) map.caption = {"a map", "and a line"};
  REQUIRE(sheet.write());
  const Pixels in_rows(sheet.path);
  CHECK(in_rows.height() > in_one_row.height());
  CHECK(area_of(in_rows, 1) > 1.5 * largest);  // two columns in place of three
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
