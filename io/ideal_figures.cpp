#include "io/ideal_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace planish {
namespace {

Vec2 mean_of(In<Vec2> point) {
  Vec2 sum;
  for (const Vec2 p : point) sum += p;
  return (1 / static_cast<double>(point.size())) * sum;
}

/// Largest distance from the mean.
double extent_of(In<Vec2> point, Vec2 mean) {
  double extent = 0;
  for (const Vec2 p : point) extent = std::max(extent, norm(p - mean));
  return extent;
}

/// The circle for which sum (|p - centre|^2 - radius^2)^2 is least, with the mean as origin: two linear equations.
std::optional<FittedCircle> algebraic_circle(In<Vec2> point, Vec2 mean, double extent) {
  double xx = 0, xy = 0, yy = 0, xq = 0, yq = 0;
  for (const Vec2 p : point) {
    const Vec2 d = (1 / extent) * (p - mean);
    const double q = dot(d, d);
    xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y, xq += d.x * q, yq += d.y * q;
  }
  const double determinant = xx * yy - xy * xy;
  constexpr double kStraight = 1e-14;
  if (!(determinant > kStraight * (xx + yy) * (xx + yy))) return {};
  const Vec2 centre = (0.5 / determinant) * Vec2{xq * yy - yq * xy, yq * xx - xq * xy};
  const double radius = std::sqrt(dot(centre, centre) + (xx + yy) / static_cast<double>(point.size()));
  return FittedCircle{mean + extent * centre, extent * radius};
}

double sum_of_squares(In<Vec2> point, const FittedCircle& circle) {
  double sum = 0;
  for (const Vec2 p : point) {
    const double off = norm(p - circle.centre) - circle.radius;
    sum += off * off;
  }
  return sum;
}

/// One step towards the least sum of squared distances. The best radius of a centre is the mean distance, so that
/// only the centre is unknown: the rows are the directions to the points less their mean.
FittedCircle gauss_newton_step(In<Vec2> point, const FittedCircle& circle) {
  const auto n = static_cast<double>(point.size());
  std::vector<Vec2> toward;
  Vec2 mean_toward;
  double mean_distance = 0;
  for (const Vec2 p : point) {
    const double distance = norm(p - circle.centre);
    toward.push_back(distance > 0 ? (1 / distance) * (p - circle.centre) : Vec2{});
    mean_toward += (1 / n) * toward.back();
    mean_distance += distance / n;
  }
  double xx = 0, xy = 0, yy = 0;
  Vec2 right;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const Vec2 row = toward[i] - mean_toward;
    xx += row.x * row.x, xy += row.x * row.y, yy += row.y * row.y;
    right += (norm(point[i] - circle.centre) - mean_distance) * row;
  }
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 0)) return circle;
  const Vec2 step = (1 / determinant) * Vec2{right.x * yy - right.y * xy, right.y * xx - right.x * xy};
  FittedCircle next{circle.centre + step, 0};
  for (const Vec2 p : point) next.radius += norm(p - next.centre) / n;
  return next;
}

bool is_inside(Vec2 p, const PixelBox& box) {
  return p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y && p.y <= box.upper.y;
}

/// Where the circle crosses the four lines through the box's sides, in [0, 2 pi], ascending; both ends included.
std::vector<double> crossings(const FittedCircle& circle, const PixelBox& box) {
  std::vector<double> angle{0, 2 * kPi};
  const auto add = [&](double a) { angle.push_back(a < 0 ? a + 2 * kPi : a); };
  for (const double x : {box.lower.x, box.upper.x}) {
    const double cosine = (x - circle.centre.x) / circle.radius;
    if (std::abs(cosine) >= 1) continue;
    add(std::acos(cosine));
    add(-std::acos(cosine));
  }
  for (const double y : {box.lower.y, box.upper.y}) {
    const double sine = (y - circle.centre.y) / circle.radius;
    if (std::abs(sine) >= 1) continue;
    add(std::asin(sine));
    add(kPi - std::asin(sine));
  }
  std::ranges::sort(angle);
  return angle;
}

}  // namespace

std::optional<FittedLine> fit_line(In<Vec2> point) {
  if (point.empty()) return {};
  FittedLine line{.point = mean_of(point), .direction = {}};
  double xx = 0, xy = 0, yy = 0;
  for (const Vec2 p : point) {
    const Vec2 d = p - line.point;
    xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
  }
  if (!(xx + yy > 0)) return {};
  line.direction = unit(0.5 * std::atan2(2 * xy, xx - yy));
  for (const Vec2 p : point) {
    const double s = dot(p - line.point, line.direction);
    line.first = std::min(line.first, s);
    line.last = std::max(line.last, s);
  }
  return line;
}

std::optional<FittedCircle> fit_circle(In<Vec2> point) {
  if (point.size() < 3) return {};
  const Vec2 mean = mean_of(point);
  const double extent = extent_of(point, mean);
  if (!(extent > 0)) return {};
  std::optional<FittedCircle> circle = algebraic_circle(point, mean, extent);
  if (!circle) return {};
  constexpr int kMostSteps = 20;
  double best = sum_of_squares(point, *circle);
  for (int k = 0; k < kMostSteps; ++k) {
    const FittedCircle next = gauss_newton_step(point, *circle);
    const double found = sum_of_squares(point, next);
    if (!(found < best)) break;
    circle = next;
    best = found;
  }
  constexpr double kLargest = 1e4;
  if (!(circle->radius <= kLargest * extent)) return {};
  return circle;
}

std::vector<Vec2> part_inside(const FittedLine& line, double beyond, const PixelBox& box) {
  double first = line.first - beyond, last = line.last + beyond;
  const auto clip = [&](double at, double slope, double lower, double upper) {
    if (slope == 0) {
      if (at < lower || at > upper) last = -kInfinity;
      return;
    }
    const double a = (lower - at) / slope, b = (upper - at) / slope;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  };
  clip(line.point.x, line.direction.x, box.lower.x, box.upper.x);
  clip(line.point.y, line.direction.y, box.lower.y, box.upper.y);
  if (first >= last) return {};
  return {line.point + first * line.direction, line.point + last * line.direction};
}

std::vector<std::vector<Vec2>> parts_inside(const FittedCircle& circle, double step, const PixelBox& box) {
  const auto at = [&](double angle) { return circle.centre + circle.radius * unit(angle); };
  const std::vector<double> angle = crossings(circle, box);
  std::vector<std::vector<Vec2>> arcs;
  bool joins = false;  // the arc before ends where this one begins
  for (std::size_t i = 0; i + 1 < angle.size(); ++i) {
    const double from = angle[i], sweep = angle[i + 1] - from;
    if (sweep == 0) continue;
    if (!is_inside(at(from + 0.5 * sweep), box)) {
      joins = false;
      continue;
    }
    if (!joins) arcs.push_back({at(from)});
    joins = true;
    const int steps = std::max(1, static_cast<int>(std::ceil(sweep * circle.radius / step)));
    for (int k = 1; k <= steps; ++k) arcs.back().push_back(at(from + sweep * k / steps));
  }
  return arcs;
}

}  // namespace planish
