#include "io/feature_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/page.hpp"

namespace planish {
namespace {

constexpr double kStep = 3;        // pixels between two looks along an edge
constexpr double kNearest = 0.35;  // pixels between two points that are worth drawing

/// Sizes at a picture of 1600 pixels.
constexpr double kChainWidth = 5, kRimWidth = 8;
constexpr double kIdealDash = 8, kIdealGap = 7;

Vec2 flat(Vec3 p) { return {p.x, p.y}; }

/// Grows the last run, or begins another one where sight changes; runs join in a common point.
void extend(std::vector<LineRun>& runs, Vec2 from, Vec2 to, bool seen, bool last) {
  if (runs.empty() || runs.back().seen != seen) runs.push_back({{from}, seen});
  std::vector<Vec2>& point = runs.back().point;
  if (last || norm(to - point.back()) >= kNearest) point.push_back(to);
}

}  // namespace

std::vector<LineRun> split_by_sight(const DepthRaster& surface, In<Vec3> point, In<Index> chain, bool closed,
                                    double slack) {
  std::vector<LineRun> runs;
  const std::size_t num_edges = chain.size() - (closed ? 0 : 1);
  for (std::size_t k = 0; k < num_edges; ++k) {
    const Vec3 a = point[chain[k]], b = point[chain[(k + 1) % chain.size()]];
    const int steps = std::max(1, static_cast<int>(std::ceil(norm(flat(b) - flat(a)) / kStep)));
    const auto at = [&](double i) { return a + (i / steps) * (b - a); };
    for (int i = 0; i < steps; ++i) {
      const bool last = k + 1 == num_edges && i + 1 == steps;
      extend(runs, flat(at(i)), flat(at(i + 1)), surface.sees(at(i + 0.5), slack), last);
    }
  }
  return runs;
}

std::vector<Vec2> visible_line(In<Index> chain, In<Vec2> point) {
  std::vector<Vec2> line{point[chain.front()]};
  for (const Index v : chain) {
    if (norm(point[v] - line.back()) >= kNearest) line.push_back(point[v]);
  }
  if (line.back() != point[chain.back()]) line.push_back(point[chain.back()]);
  return line;
}

std::vector<Vec2> subdivided(In<Vec2> line, bool closed, double step) {
  std::vector<Vec2> fine{line.front()};
  for (std::size_t i = 1; i < line.size() + (closed ? 1 : 0); ++i) {
    const Vec2 a = line[i - 1], way = line[i % line.size()] - a;
    const int steps = std::max(1, static_cast<int>(std::ceil(norm(way) / step)));
    for (int k = 1; k <= steps; ++k) fine.push_back(a + (static_cast<double>(k) / steps) * way);
  }
  return fine;
}

void draw_chain(Canvas& canvas, In<Vec2> line, bool closed, Rgb colour, double unit) {
  canvas.polyline(line, closed, {kPaper, unit * kRimWidth, 0.75});
  canvas.polyline(line, closed, {colour, unit * kChainWidth, 1});
}

void draw_ideal(Canvas& canvas, In<Vec2> line, double unit) {
  draw_dashed(canvas, line, unit * kIdealDash, unit * kIdealGap, {kInk, unit * kIdealWidth, 1});
}

void draw_dashed(Canvas& canvas, In<Vec2> point, double on, double off, const Stroke& stroke) {
  double left = on;  // of the present dash or gap
  bool drawing = true;
  std::vector<Vec2> dash{point.front()};
  for (std::size_t i = 1; i < point.size(); ++i) {
    const Vec2 way = point[i] - point[i - 1];
    const double length = norm(way);
    double done = 0;
    while (length - done > left) {
      done += left;
      const Vec2 end = point[i - 1] + (done / length) * way;
      dash.push_back(end);
      if (drawing) canvas.polyline(dash, false, stroke);
      dash = {end};
      drawing = !drawing;
      left = drawing ? on : off;
    }
    left -= length - done;
    dash.push_back(point[i]);
  }
  if (drawing && dash.size() > 1) canvas.polyline(dash, false, stroke);
}

Rgb feature_colour(std::size_t number) {
  constexpr std::array kColours = {Rgb{0.00, 0.36, 0.73}, Rgb{0.84, 0.25, 0.00}, Rgb{0.00, 0.55, 0.33},
                                   Rgb{0.62, 0.15, 0.62}, Rgb{0.93, 0.57, 0.00}, Rgb{0.00, 0.62, 0.78},
                                   Rgb{0.78, 0.05, 0.22}, Rgb{0.45, 0.33, 0.10}, Rgb{0.93, 0.35, 0.63},
                                   Rgb{0.40, 0.60, 0.00}, Rgb{0.30, 0.25, 0.65}, Rgb{0.25, 0.25, 0.25}};
  const double darker = std::pow(0.7, static_cast<double>(number / kColours.size() % 3));
  const Rgb c = kColours[number % kColours.size()];
  return {darker * c.r, darker * c.g, darker * c.b};
}

}  // namespace planish
