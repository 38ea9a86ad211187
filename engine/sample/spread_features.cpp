#include "engine/sample/spread_features.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "engine/sample/shapes.hpp"

namespace planish {
namespace {

constexpr double kFill = 0.6;                // of the largest disk around the middle of a cell
constexpr double kGoldenAngle = 2.39996323;  // turns a line against all lines near it
constexpr double kSpacing = 0.005;           // of points, metres: the presses' creases have a radius of 0.008
constexpr Index kFewestPoints = 12, kMostPoints = 40;
constexpr Index kCellBlock = 64;

/// A rectangle of the unit square.
struct Cell {
  double u_begin, u_end, v_begin, v_end, u_middle;
};

double mix(double a, double b, double t) { return a + (b - a) * t; }

/// Cells about as wide as their band of rows is high; bands share the cells out by how many fit.
std::vector<Cell> cut_cells(const RowDomain& domain, Index count) {
  constexpr Index kRows = 64;
  double fitting = 0;  // if there were one band
  for (Index r = 0; r < kRows; ++r) fitting += integrate_row(domain, (r + 0.5) / kRows).back() / kRows;
  const Index bands =
      std::clamp<Index>(static_cast<Index>(std::lround(std::sqrt(count / fitting))), 1, count);
  std::vector<RowIntegral> middle(bands);
  double total = 0;
  for (Index b = 0; b < bands; ++b) {
    middle[b] = integrate_row(domain, (b + 0.5) / bands);
    total += middle[b].back();
  }
  std::vector<Cell> cells;
  cells.reserve(count);
  double sum = 0;
  for (Index b = 0; b < bands; ++b) {
    sum += middle[b].back();
    const Index end = b + 1 == bands ? count : static_cast<Index>(std::lround(count * sum / total));
    const Index columns = end - static_cast<Index>(cells.size());
    const auto u_at = [&](double column) { return position_in_row(middle[b], column / columns); };
    for (Index i = 0; i < columns; ++i) {
      cells.push_back({u_at(i), u_at(i + 1), static_cast<double>(b) / bands,
                       static_cast<double>(b + 1) / bands, u_at(i + 0.5)});
    }
  }
  return cells;
}

double distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double squared = dot(d, d);
  const double s = squared > 0 ? std::clamp(dot(p - a, d) / squared, 0.0, 1.0) : 0;
  return norm(p - a - s * d);
}

/// A disk in the chart.
struct Disk {
  Vec2 middle;
  double radius;
};

/// The largest disk around the middle of a cell that its outline leaves room for.
Disk disk_in(const Cell& cell, const RowDomain& domain) {
  constexpr Index kSide = 16;  // segments of each side of the outline
  const Vec2 middle = domain.chart(cell.u_middle, mix(cell.v_begin, cell.v_end, 0.5));
  double radius = kInfinity;
  const auto side = [&](double u_from, double v_from, double u_to, double v_to) {
    Vec2 previous = domain.chart(u_from, v_from);
    for (Index i = 1; i <= kSide; ++i) {
      const double s = i / static_cast<double>(kSide);
      const Vec2 next = domain.chart(mix(u_from, u_to, s), mix(v_from, v_to, s));
      radius = std::min(radius, distance_to_segment(middle, previous, next));
      previous = next;
    }
  };
  side(cell.u_begin, cell.v_begin, cell.u_end, cell.v_begin);
  side(cell.u_end, cell.v_begin, cell.u_end, cell.v_end);
  side(cell.u_end, cell.v_end, cell.u_begin, cell.v_end);
  side(cell.u_begin, cell.v_end, cell.u_begin, cell.v_begin);
  return {middle, radius};
}

Index points_along(double length) {
  return static_cast<Index>(std::clamp<double>(std::ceil(length / kSpacing), kFewestPoints, kMostPoints));
}

SampleFeature line_in(const Disk& disk, double angle, const std::function<Vec3(Vec2)>& surface) {
  const double reach = kFill * disk.radius;
  const Vec2 d = unit(angle);
  return {"", trace([&](double s) { return surface(disk.middle + mix(-reach, reach, s) * d); },
                    points_along(2 * reach))};
}

SampleFeature circle_in(const Disk& disk, const std::function<Vec3(Vec2)>& surface) {
  const double radius = kFill * disk.radius;
  return {"",
          trace([&](double s) { return surface(disk.middle + radius * unit(2 * kPi * s)); },
                points_along(2 * kPi * radius), true),
          true};
}

}  // namespace

void spread_features(const Exec& exec, const RowDomain& domain, const std::function<Vec3(Vec2)>& surface,
                     Index count, Sample& sample) {
  const std::vector<Cell> cells = cut_cells(domain, count);
  sample.features.assign(count, {});
  sample.constraints.assign(count, {});
  exec.for_blocks(count, kCellBlock, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) {
      const char* const type = i % 2 == 0 ? "line" : "circle";
      const Disk disk = disk_in(cells[i], domain);
      SampleFeature& feature = sample.features[i];
      feature = i % 2 == 0 ? line_in(disk, kGoldenAngle * i, surface) : circle_in(disk, surface);
      feature.name = fmt::format("{}_{:04}", type, i + 1);
      sample.constraints[i] = {type, {feature.name}, {}};
    }
  });
}

}  // namespace planish
