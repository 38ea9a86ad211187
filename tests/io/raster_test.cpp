#include "io/raster.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "io/colour_scale.hpp"

namespace planish {
namespace {

struct Tiling {
  std::vector<Vec2> point;
  std::vector<Index> corner_vertex;
  std::vector<float> value;
};

/// A square of n x n cells over the whole picture, inner points moved at random; every second triangle turned
/// over, which must not matter.
Tiling random_tiling(int n, double width, double height) {
  Tiling tiling;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-0.3, 0.3);
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const bool inner_x = i > 0 && i<n, inner_y = j> 0 && j < n;
      const double dx = unit(random), dy = unit(random);
      tiling.point.push_back({(i + (inner_x ? dx : 0)) * width / n, (j + (inner_y ? dy : 0)) * height / n});
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      tiling.corner_vertex.insert(tiling.corner_vertex.end(), {a, b, d, a, c, d});
    }
  }
  tiling.value.assign(tiling.corner_vertex.size() / 3, 0);
  return tiling;
}

Raster draw(const Tiling& tiling, int width, int height, int threads = 0) {
  return rasterise(Exec(threads), tiling.corner_vertex, tiling.point, tiling.value, width, height);
}

TEST_CASE("raster: a tiling covers every pixel, with triangles larger and smaller than a pixel") {
  for (const int n : {1, 3, 17, 60, 400}) {
    const Raster raster = draw(random_tiling(n, 97, 61), 97, 61);
    CHECK(std::ranges::count(raster.pixel, premultiplied(diverging_colour(0), 1)) == 97 * 61);
  }
}

TEST_CASE("raster: each sample belongs to one triangle, so areas add up") {
  // Two halves of a square along its diagonal, which runs through sample centres: drawn alone, their
  // coverages sum to that of the square.
  const std::vector<Vec2> point{{0, 0}, {8, 0}, {8, 8}, {0, 8}};
  const auto coverage = [&](std::vector<Index> corner_vertex) {
    const std::vector<float> value(corner_vertex.size() / 3, 0);
    const Raster raster = rasterise(Exec(), corner_vertex, point, value, 8, 8);
    double alpha = 0;
    for (const std::uint32_t p : raster.pixel) alpha += std::round((p >> 24) / 255.0 * 4) / 4;
    return alpha;
  };
  CHECK(coverage({0, 1, 2}) + coverage({0, 2, 3}) == 64);
  CHECK(coverage({0, 1, 3}) + coverage({1, 2, 3}) == 64);
  CHECK(coverage({0, 1, 2, 0, 2, 3}) == 64);
}

TEST_CASE("raster: a thin diagonal sliver costs its rows and shows its value") {
  const std::vector<Vec2> point{{0, 0}, {300, 298}, {300, 300}};
  const std::vector<Index> corner_vertex{0, 1, 2};
  const std::vector<float> value{1};
  const Raster raster = rasterise(Exec(), corner_vertex, point, value, 300, 300);
  const auto covered = std::ranges::count_if(raster.pixel, [](std::uint32_t p) { return p != 0; });
  CHECK(covered > 300);
  CHECK(covered < 900);
  CHECK(raster.pixel[299 * 300 + 299] != 0);
}

TEST_CASE("raster: flipped triangles lie over later ones, in their own colour") {
  const std::vector<Vec2> point{{0, 0}, {10, 0}, {0, 10}};
  const std::vector<Index> corner_vertex{0, 2, 1, 0, 1, 2};
  const std::vector<float> value{kFlippedValue, 1};
  const Raster raster = rasterise(Exec(), corner_vertex, point, value, 10, 10);
  CHECK(raster.pixel[0] == premultiplied(kFlipColour, 1));
}

TEST_CASE("raster: a pixel takes the colour of the mean of its samples") {
  const std::vector<Vec2> point{{0, 0}, {0.5, 0}, {1, 0}, {0, 1}, {0.5, 1}, {1, 1}};
  const std::vector<Index> corner_vertex{0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  const std::vector<float> value{1, 1, -0.5f, -0.5f};
  const Raster raster = rasterise(Exec(), corner_vertex, point, value, 1, 1);
  const Rgb expected = diverging_colour(0.25);
  CHECK(std::abs(static_cast<int>(raster.pixel[0] >> 16 & 255) - std::lround(255 * expected.r)) <= 1);
  CHECK(std::abs(static_cast<int>(raster.pixel[0] & 255) - std::lround(255 * expected.b)) <= 1);
}

TEST_CASE("raster: triangles without area leave no pixel") {
  const std::vector<Vec2> point{{3, 3}, {5, 5}, {4, 4}};
  const std::vector<Index> corner_vertex{0, 1, 2, 0, 0, 0};
  const std::vector<float> value{0, 0};
  const Raster raster = rasterise(Exec(), corner_vertex, point, value, 8, 8);
  CHECK(std::ranges::count(raster.pixel, 0u) == 64);
}

TEST_CASE("raster: 1, 2 and 7 threads give the same pixels") {
  Tiling tiling = random_tiling(150, 210, 130);
  for (std::size_t t = 0; t < tiling.value.size(); ++t) tiling.value[t] = std::sin(static_cast<float>(t));
  const Raster one = draw(tiling, 210, 130, 1);
  for (const int threads : {2, 7}) CHECK(draw(tiling, 210, 130, threads).pixel == one.pixel);
}

}  // namespace
}  // namespace planish
