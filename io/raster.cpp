#include "io/raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "io/colour_scale.hpp"

namespace planish {
namespace {

constexpr int kSamples = 2;      // a pixel has kSamples x kSamples of them
constexpr int kBandPixels = 16;  // rows a band; the samples of one band stay in the second-level cache
constexpr int kBandSamples = kBandPixels * kSamples;
constexpr int kSubdivision =
    256;  // fixed-point steps a sample: edges are decided exactly, neighbours never both or neither
constexpr int kHalf = kSubdivision / 2;
constexpr int kColours = 1025;  // odd: zero has a colour of its own
constexpr float kEmpty = std::numeric_limits<float>::quiet_NaN();

struct FixedPoint {
  std::int32_t x = 0, y = 0;
};
using FixedTriangle = std::array<FixedPoint, 3>;

/// Sample indices, both ends included; empty where last < first.
struct Interval {
  Offset first = 0, last = -1;
};

/// Exact for operands below 2^53 and quotients below 2^28 (a larger one lies outside of every picture,
/// rounded or not), and faster than dividing integers: a quotient that is no whole number is at least 1 / b
/// away from one.
Offset floor_divide(Offset a, Offset b) {
  return static_cast<Offset>(std::floor(static_cast<double>(a) / static_cast<double>(b)));
}
Offset ceil_divide(Offset a, Offset b) { return -floor_divide(-a, b); }

/// Samples whose centres lie between two fixed coordinates, >= 0.
Interval samples_between(std::int32_t low, std::int32_t high) {
  return {(low + kHalf - 1) / kSubdivision, (high + kHalf) / kSubdivision - 1};
}

FixedTriangle gather(In<Index> corner_vertex, In<FixedPoint> point, Index t) {
  return {point[corner_vertex[3 * t]], point[corner_vertex[3 * t + 1]], point[corner_vertex[3 * t + 2]]};
}

Interval sample_rows(const FixedTriangle& p) {
  const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
  return samples_between(low, high);
}

/// Narrows the columns of a row to those on the inner side of edge a->b of a triangle with its inside on the
/// left (y down). Centres on the edge belong to it where it runs down, or right along a row: each to one of
/// two neighbours.
void clip_to_edge(FixedPoint a, FixedPoint b, Offset row, Interval& columns) {
  const Offset dx = b.x - a.x, dy = b.y - a.y;
  const bool owns_its_points = dy > 0 || (dy == 0 && dx > 0);
  const Offset y = row * kSubdivision + kHalf;
  // inside(i) = at_zero + i * step >= 0
  const Offset at_zero = dy * (kHalf - Offset{a.x}) - dx * (y - a.y) - (owns_its_points ? 0 : 1);
  const Offset step = dy * kSubdivision;
  if (step > 0) {
    columns.first = std::max(columns.first, ceil_divide(-at_zero, step));
  } else if (step < 0) {
    columns.last = std::min(columns.last, floor_divide(at_zero, -step));
  } else if (at_zero < 0) {
    columns.last = columns.first - 1;
  }
}

/// Writes value to the samples of p in rows [first_row, first_row + kBandSamples); row_length samples a row.
void fill(FixedTriangle p, float value, Offset first_row, int row_length, Out<float> sample) {
  const Offset doubled_area =
      Offset{p[1].y - p[0].y} * (p[2].x - p[0].x) - Offset{p[1].x - p[0].x} * (p[2].y - p[0].y);
  if (doubled_area == 0) return;
  if (doubled_area < 0) std::swap(p[1], p[2]);
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const Interval box = samples_between(left, right);
  const Interval rows = sample_rows(p);
  const Offset last_row = std::min(rows.last, first_row + kBandSamples - 1);
  for (Offset row = std::max(rows.first, first_row); row <= last_row; ++row) {
    Interval columns{box.first, std::min<Offset>(box.last, row_length - 1)};
    for (int i = 0; i < 3; ++i) clip_to_edge(p[i], p[(i + 1) % 3], row, columns);
    float* const line = sample.data() + (row - first_row) * row_length;
    for (Offset i = columns.first; i <= columns.last; ++i) line[i] = value;
  }
}

/// The triangles that touch each band, ascending.
struct BandLists {
  std::vector<Offset> begin;  ///< [bands + 1]
  std::vector<Index> triangle;
};

/// Calls body(band) for each band that triangle p touches.
template <class Body>
void for_bands(const FixedTriangle& p, Index num_bands, Body&& body) {
  const Interval rows = sample_rows(p);
  if (rows.last < rows.first) return;
  const Offset last = std::min<Offset>(num_bands - 1, rows.last / kBandSamples);
  for (Offset band = rows.first / kBandSamples; band <= last; ++band) body(band);
}

BandLists sort_into_bands(const Exec& exec, In<Index> corner_vertex, In<FixedPoint> point, Index num_bands) {
  constexpr Index kTrianglesABlock = 1 << 14;
  const auto num_triangles = static_cast<Index>(corner_vertex.size() / 3);
  std::vector<Offset> place(static_cast<std::size_t>(Exec::num_blocks(num_triangles, kTrianglesABlock)) *
                            num_bands);
  const auto row_of = [&](Index block) { return place.begin() + static_cast<Offset>(block) * num_bands; };
  exec.for_blocks(num_triangles, kTrianglesABlock, [&](Index block, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      for_bands(gather(corner_vertex, point, t), num_bands, [&](Offset band) { ++row_of(block)[band]; });
    }
  });
  BandLists lists;
  Offset total = 0;
  for (Index band = 0; band < num_bands; ++band) {
    lists.begin.push_back(total);
    for (std::size_t k = band; k < place.size(); k += num_bands) total += std::exchange(place[k], total);
  }
  lists.begin.push_back(total);
  lists.triangle.resize(total);
  exec.for_blocks(num_triangles, kTrianglesABlock, [&](Index block, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      for_bands(gather(corner_vertex, point, t), num_bands,
                [&](Offset band) { lists.triangle[row_of(block)[band]++] = t; });
    }
  });
  return lists;
}

std::vector<FixedPoint> to_fixed(const Exec& exec, In<Vec2> point) {
  std::vector<FixedPoint> fixed(point.size());
  exec.for_blocks(static_cast<Index>(point.size()), kBlock, [&](Index, Range r) {
    constexpr double kScale = kSamples * kSubdivision;
    for (Index v = r.begin; v < r.end; ++v) {
      fixed[v] = {static_cast<std::int32_t>(kScale * point[v].x + 0.5),
                  static_cast<std::int32_t>(kScale * point[v].y + 0.5)};
    }
  });
  return fixed;
}

using Palette = std::array<Rgb, kColours>;

Palette make_palette() {
  Palette palette;
  for (int k = 0; k < kColours; ++k) palette[k] = diverging_colour(2.0 * k / (kColours - 1) - 1);
  return palette;
}

/// Colour of one pixel from its samples.
std::uint32_t blend(const Palette& palette, In<float> upper, In<float> lower) {
  int covered = 0, flipped = 0;
  float sum = 0;
  for (const In<float> row : {upper, lower}) {
    for (const float s : row) {
      if (s == kFlippedValue) {
        ++flipped;
      } else if (s == s) {
        sum += s;
        ++covered;
      }
    }
  }
  if (covered + flipped == 0) return 0;
  const double alpha = static_cast<double>(covered + flipped) / (kSamples * kSamples);
  if (covered == 0) return premultiplied(kFlipColour, alpha);
  const float mean = sum / static_cast<float>(covered);
  const Rgb c = palette[static_cast<int>(0.5f * (mean + 1) * (kColours - 1) + 0.5f)];
  const double f = static_cast<double>(flipped) / (covered + flipped);
  return premultiplied(
      {std::lerp(c.r, kFlipColour.r, f), std::lerp(c.g, kFlipColour.g, f), std::lerp(c.b, kFlipColour.b, f)},
      alpha);
}

}  // namespace

Raster rasterise(const Exec& exec, In<Index> corner_vertex, In<Vec2> point, In<float> value, int width,
                 int height) {
  Raster raster{width, height, std::vector<std::uint32_t>(static_cast<std::size_t>(width) * height)};
  const std::vector<FixedPoint> fixed = to_fixed(exec, point);
  const Index num_bands = (height + kBandPixels - 1) / kBandPixels;
  const BandLists bands = sort_into_bands(exec, corner_vertex, fixed, num_bands);
  const Palette palette = make_palette();
  const int row_length = width * kSamples;
  exec.for_tasks(num_bands, [&](Index band) {
    std::vector<float> sample(static_cast<std::size_t>(row_length) * kBandSamples, kEmpty);
    const In<Index> list =
        In<Index>(bands.triangle).subspan(bands.begin[band], bands.begin[band + 1] - bands.begin[band]);
    for (const bool flips : {false, true}) {
      for (const Index t : list) {
        if ((value[t] == kFlippedValue) != flips) continue;
        fill(gather(corner_vertex, fixed, t), value[t], Offset{band} * kBandSamples, row_length, sample);
      }
    }
    const int last = std::min(height, (band + 1) * kBandPixels);
    for (int y = band * kBandPixels; y < last; ++y) {
      const float* const upper =
          sample.data() + static_cast<Offset>(y - band * kBandPixels) * kSamples * row_length;
      for (int x = 0; x < width; ++x) {
        raster.pixel[static_cast<std::size_t>(y) * width + x] =
            blend(palette, {upper + x * kSamples, kSamples}, {upper + row_length + x * kSamples, kSamples});
      }
    }
  });
  return raster;
}

}  // namespace planish
