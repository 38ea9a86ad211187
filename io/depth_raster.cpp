#include "io/depth_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace planish {
namespace {

constexpr int kSamples = 2;      // a pixel has kSamples x kSamples of them
constexpr int kBandPixels = 16;  // rows a band; the samples of one band stay in the second-level cache
constexpr int kBandSamples = kBandPixels * kSamples;
constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// The nearest point found so far.
struct Sample {
  float depth = kNothing;
  float grey = 0;
  Index tint = kNone;
};

/// x y in samples, z in pixels.
struct Corner {
  double x, y, z, grey;
};
using Triangle = std::array<Corner, 3>;

Triangle gather(const ShadedTriangles& triangles, Index t) {
  Triangle triangle;
  for (int i = 0; i < 3; ++i) {
    const Index v = triangles.corner_vertex[3 * t + i];
    const Vec3 p = triangles.point[v];
    triangle[i] = {kSamples * p.x, kSamples * p.y, p.z, triangles.grey[v]};
  }
  return triangle;
}

/// Samples whose centres lie between two coordinates, both ends included; empty where last < first.
struct Interval {
  Offset first = 0, last = -1;
};
Interval samples_between(double low, double high) {
  return {static_cast<Offset>(std::ceil(low - 0.5)), static_cast<Offset>(std::floor(high - 0.5))};
}

Interval sample_rows(const Triangle& p) {
  const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
  return samples_between(low, high);
}

/// What a triangle covers of a row. Both sides of an edge find the same end: no sample falls between.
Interval columns_of(const Triangle& p, double y) {
  double low = kInfinity, high = -kInfinity;
  for (int i = 0; i < 3; ++i) {
    Corner a = p[i], b = p[(i + 1) % 3];
    if (std::pair(b.y, b.x) < std::pair(a.y, a.x)) std::swap(a, b);
    if (y < a.y || y > b.y) continue;
    const double x = a.y == b.y ? a.x : a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    low = std::min({low, x, a.y == b.y ? b.x : x});
    high = std::max({high, x, a.y == b.y ? b.x : x});
  }
  return low <= high ? samples_between(low, high) : Interval{};
}

/// A quantity linear over a triangle, kept between its corners' values where the triangle is seen from the
/// side.
struct Plane {
  double at_origin, per_x, per_y, low, high;
  float at(double x, double y) const {
    return static_cast<float>(std::clamp(at_origin + per_x * x + per_y * y, low, high));
  }
};

Plane plane_of(const Triangle& p, double doubled_area, double Corner::*value) {
  const double f = p[0].*value, g = p[1].*value - f, h = p[2].*value - f;
  const double per_x = (g * (p[2].y - p[0].y) - h * (p[1].y - p[0].y)) / doubled_area;
  const double per_y = (h * (p[1].x - p[0].x) - g * (p[2].x - p[0].x)) / doubled_area;
  const auto [low, high] = std::minmax({f, f + g, f + h});
  return {f - per_x * p[0].x - per_y * p[0].y, per_x, per_y, low, high};
}

/// Enters a triangle into rows [first_row, first_row + kBandSamples); row_length samples a row.
void fill(const Triangle& p, Index tint, Offset first_row, int row_length, Out<Sample> sample) {
  const double doubled_area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
  constexpr double kSmallestArea = 1e-9;
  if (!(std::abs(doubled_area) > kSmallestArea)) return;
  const Plane depth = plane_of(p, doubled_area, &Corner::z), grey = plane_of(p, doubled_area, &Corner::grey);
  const Interval rows = sample_rows(p);
  const Offset last_row = std::min(rows.last, first_row + kBandSamples - 1);
  for (Offset row = std::max(rows.first, first_row); row <= last_row; ++row) {
    const double y = static_cast<double>(row) + 0.5;
    const Interval columns = columns_of(p, y);
    Sample* const line = sample.data() + (row - first_row) * row_length;
    const Offset last = std::min<Offset>(columns.last, row_length - 1);
    for (Offset i = std::max<Offset>(columns.first, 0); i <= last; ++i) {
      const double x = static_cast<double>(i) + 0.5;
      const float z = depth.at(x, y);
      if (z > line[i].depth) line[i] = {z, grey.at(x, y), tint};
    }
  }
}

/// The triangles that touch each band, ascending.
struct BandLists {
  std::vector<Offset> begin;  ///< [bands + 1]
  std::vector<Index> triangle;
};

BandLists sort_into_bands(const ShadedTriangles& triangles, Index num_bands) {
  const auto num_triangles = static_cast<Index>(triangles.corner_vertex.size() / 3);
  const auto for_bands = [&](Index t, auto&& body) {
    const Interval rows = sample_rows(gather(triangles, t));
    if (rows.last < rows.first) return;
    const Offset last = std::min<Offset>(num_bands - 1, rows.last / kBandSamples);
    for (Offset band = std::max<Offset>(rows.first, 0) / kBandSamples; band <= last; ++band) body(band);
  };
  BandLists lists;
  lists.begin.assign(num_bands + 1, 0);
  for (Index t = 0; t < num_triangles; ++t) for_bands(t, [&](Offset band) { ++lists.begin[band + 1]; });
  for (Index band = 0; band < num_bands; ++band) lists.begin[band + 1] += lists.begin[band];
  lists.triangle.resize(lists.begin.back());
  std::vector<Offset> place(lists.begin.begin(), lists.begin.end() - 1);
  for (Index t = 0; t < num_triangles; ++t) {
    for_bands(t, [&](Offset band) { lists.triangle[place[band]++] = t; });
  }
  return lists;
}

/// Colour and depth of one pixel from its samples.
std::pair<std::uint32_t, float> resolve(const std::array<In<Sample>, kSamples>& rows, In<Rgb> tint_colour) {
  Rgb sum;
  int covered = 0;
  float depth = kInfinity;
  for (const In<Sample> row : rows) {
    for (const Sample& s : row) {
      depth = std::min(depth, s.depth);
      if (s.depth == kNothing) continue;
      ++covered;
      const double grey = s.grey, share = s.tint == kNone ? 0 : kTintShare;
      const Rgb tint = s.tint == kNone ? Rgb{} : tint_colour[s.tint];
      sum.r += grey * std::lerp(1, tint.r, share);
      sum.g += grey * std::lerp(1, tint.g, share);
      sum.b += grey * std::lerp(1, tint.b, share);
    }
  }
  if (covered == 0) return {0, depth};
  const double n = covered;
  return {premultiplied({sum.r / n, sum.g / n, sum.b / n}, n / (kSamples * kSamples)), depth};
}

}  // namespace

bool DepthRaster::sees(Vec3 point, double slack) const {
  const int x = static_cast<int>(std::floor(point.x)), y = static_cast<int>(std::floor(point.y));
  // A pixel around, so that edges of the surface and steep parts do not hide what lies on them.
  for (int j = y - 1; j <= y + 1; ++j) {
    for (int i = x - 1; i <= x + 1; ++i) {
      if (i < 0 || j < 0 || i >= raster.width || j >= raster.height) return true;
      if (point.z + slack >= depth[static_cast<std::size_t>(j) * raster.width + i]) return true;
    }
  }
  return false;
}

DepthRaster rasterise_depth(const Exec& exec, const ShadedTriangles& triangles, int width, int height) {
  const std::size_t num_pixels = static_cast<std::size_t>(width) * height;
  DepthRaster result{{width, height, std::vector<std::uint32_t>(num_pixels)}, std::vector<float>(num_pixels)};
  const Index num_bands = (height + kBandPixels - 1) / kBandPixels;
  const BandLists bands = sort_into_bands(triangles, num_bands);
  const int row_length = width * kSamples;
  exec.for_tasks(num_bands, [&](Index band) {
    std::vector<Sample> sample(static_cast<std::size_t>(row_length) * kBandSamples);
    for (Offset k = bands.begin[band]; k < bands.begin[band + 1]; ++k) {
      const Index t = bands.triangle[k];
      fill(gather(triangles, t), triangles.tint.empty() ? kNone : triangles.tint[t],
           Offset{band} * kBandSamples, row_length, sample);
    }
    const int first = band * kBandPixels, last = std::min(height, first + kBandPixels);
    for (int y = first; y < last; ++y) {
      const Sample* const upper = sample.data() + static_cast<Offset>(y - first) * kSamples * row_length;
      for (int x = 0; x < width; ++x) {
        const Sample* const corner = upper + x * kSamples;
        const std::size_t pixel = static_cast<std::size_t>(y) * width + x;
        std::tie(result.raster.pixel[pixel], result.depth[pixel]) = resolve(
            {In<Sample>(corner, kSamples), In<Sample>(corner + row_length, kSamples)}, triangles.tint_colour);
      }
    }
  });
  return result;
}

}  // namespace planish
