#include "engine/sample/rows.hpp"

#include <algorithm>
#include <cmath>

#include "engine/sample/random.hpp"

namespace planish {
namespace {

constexpr Index kRowBlock = 16;
constexpr double kStep = 1e-5;         // of the finite differences of the chart
constexpr double kJitter = 0.26;       // of the spacing
constexpr double kHeight = 0.8660254;  // of an equilateral triangle of side 1

/// Points an edge length apart on a unit of u, for rows a unit of v apart: |P_u| / (gap * 2 / sqrt 3).
double density(const RowDomain& domain, double u, double v) {
  const double u0 = std::max(0.0, u - kStep), u1 = std::min(1.0, u + kStep);
  const double v0 = std::max(0.0, v - kStep), v1 = std::min(1.0, v + kStep);
  const Vec2 along = (1 / (u1 - u0)) * (domain.chart(u1, v) - domain.chart(u0, v));
  const Vec2 across = (1 / (v1 - v0)) * (domain.chart(u, v1) - domain.chart(u, v0));
  return kHeight * dot(along, along) / std::abs(cross(along, across));
}

/// Each edge of an inner row belongs to two strips.
Index strips_at(Index r, Index strips) { return r == 0 || r == strips ? 1 : 2; }

}  // namespace

RowIntegral integrate_row(const RowDomain& domain, double v) {
  RowIntegral sum{};
  for (Index i = 0; i < kStations; ++i) {
    sum[i + 1] = sum[i] + density(domain, (i + 0.5) / kStations, v) / kStations;
  }
  return sum;
}

double position_in_row(const RowIntegral& integral, double fraction) {
  const double value = fraction * integral.back();
  auto i = static_cast<Index>(std::upper_bound(integral.begin(), integral.end(), value) - integral.begin());
  i = std::clamp<Index>(i, 1, kStations);
  return (i - 1 + (value - integral[i - 1]) / (integral[i] - integral[i - 1])) / kStations;
}

Index num_strips(const RowDomain& domain, Index triangles) {
  constexpr Index kRows = 64;
  double mean = 0;
  for (Index r = 0; r < kRows; ++r) mean += integrate_row(domain, (r + 0.5) / kRows).back() / kRows;
  return std::max<Index>(2, static_cast<Index>(std::lround(std::sqrt(triangles / (2 * mean)))));
}

RowPlan plan_rows(const Exec& exec, const RowDomain& domain, Index strips, Index triangles) {
  RowPlan plan{strips, std::vector<RowIntegral>(strips + 1), {}, {0}, {0}};
  exec.for_blocks(strips + 1, kRowBlock, [&](Index, Range rows) {
    for (Index r = rows.begin; r < rows.end; ++r) {
      const bool is_point = domain.shape == RowShape::Rings && r == 0;
      if (!is_point) plan.row_integral[r] = integrate_row(domain, static_cast<double>(r) / strips);
    }
  });
  double total = 0;
  for (Index r = 0; r <= strips; ++r) total += plan.row_integral[r].back() * strips_at(r, strips);
  const bool closed = domain.shape != RowShape::Open;
  double wanted = 0, planned = 0;  // rounding is carried to the next row
  for (Index r = 0; r <= strips; ++r) {
    const bool is_point = domain.shape == RowShape::Rings && r == 0;
    const Index weight = strips_at(r, strips);
    wanted += plan.row_integral[r].back() * weight * triangles / total;
    const auto rounded = static_cast<Index>(std::lround((wanted - planned) / weight));
    plan.row_edges.push_back(is_point ? 0 : std::max<Index>(closed ? 3 : 2, rounded));
    planned += static_cast<double>(weight) * plan.row_edges.back();
    plan.row_begin.push_back(plan.row_begin.back() + plan.row_edges.back() + (closed && !is_point ? 0 : 1));
    if (r > 0) {
      plan.strip_begin.push_back(plan.strip_begin.back() + plan.row_edges[r - 1] + plan.row_edges[r]);
    }
  }
  return plan;
}

RowPoints::RowPoints(const RowDomain& domain, const RowPlan& plan, std::uint64_t seed)
    : domain_(domain), plan_(plan), seed_(seed) {}

template <class Wanted>
void RowPoints::place_points(Index r, double jitter, Wanted&& wanted, Out<Vec2> point) const {
  const double v = static_cast<double>(r) / plan_.strips;
  if (domain_.shape == RowShape::Rings && r == 0) {
    point[0] = domain_.chart(0, 0);
    return;
  }
  const Index edges = plan_.row_edges[r], first = plan_.row_begin[r];
  const bool closed = domain_.shape != RowShape::Open;
  const bool border = r == 0 || r == plan_.strips;
  const RowIntegral& integral = plan_.row_integral[r];
  // Every second row is shifted by half a spacing; rings start anywhere.
  const bool shifted = r % 2 == 1;
  const double phase = closed ? counter_random(seed_ ^ 0x5eed, r) : (shifted ? -0.5 : 0.0);
  const double spacing = 1.0 / (closed || !shifted ? edges : edges - 1);
  const auto num_points = static_cast<Index>(point.size());
  for (Index i = 0; i < num_points; ++i) {
    if (!wanted(i)) continue;
    const bool end = !closed && (i == 0 || i == num_points - 1);
    const std::uint64_t id = 2 * static_cast<std::uint64_t>(first + i);
    const double angle = 2 * kPi * counter_random(seed_, id);
    const double radius = jitter * std::sqrt(counter_random(seed_, id + 1));
    const double shift = border ? 0 : radius * std::sin(angle) / (kHeight * plan_.strips);
    double u = i == 0 ? 0 : 1;
    if (!end) {
      const double fraction = (i + phase + radius * std::cos(angle)) * spacing;
      u = position_in_row(integral, closed ? fraction - std::floor(fraction) : fraction);
    }
    point[i] = domain_.ruling ? domain_.ruling(u, r) : domain_.chart(u, v + shift);
  }
}

void RowPoints::place(Index r, bool jitter, Out<Vec2> point) const {
  place_points(
      r, jitter ? kJitter : 0, [](Index) { return true; }, point);
}

void RowPoints::put_back(Index r, In<char> still, Out<Vec2> point) const {
  if (std::find(still.begin(), still.end(), 1) == still.end()) return;
  place_points(
      r, 0, [&](Index i) { return still[i] != 0; }, point);
}

}  // namespace planish
