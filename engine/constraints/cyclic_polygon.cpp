#include "engine/constraints/cyclic_polygon.hpp"

#include <algorithm>
#include <cmath>

namespace planish {
namespace {

constexpr int kBisections = 200;  // more than a double has bits; ends when the bracket does

/// The place where a falling function changes its sign; lower and upper bracket it.
template <class Function>
double root_of_falling(double lower, double upper, Function f) {
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (lower + upper);
    if (!(middle > lower && middle < upper)) break;
    (f(middle) > 0 ? lower : upper) = middle;
  }
  return 0.5 * (lower + upper);
}

double half_sector(double length, double radius) { return std::asin(std::min(1.0, length / (2 * radius))); }

/// Sum of the edges' half sectors, the longest one counted as its reflex complement where asked for.
double half_sweep(In<double> length, std::size_t longest, bool reflex, double radius) {
  double sum = 0;
  for (std::size_t i = 0; i < length.size(); ++i) {
    const double half = half_sector(length[i], radius);
    sum += reflex && i == longest ? kPi - half : half;
  }
  return sum;
}

std::size_t longest_of(In<double> length) {
  return static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
}

/// Sectors of the edges; the longest one's takes up what rounding leaves of the sweep: where its edge is nearly a
/// diameter, its sector is the one that its length hardly determines.
std::vector<double> sectors(In<double> length, std::size_t longest, double radius, double sweep) {
  std::vector<double> sector;
  double others = 0;
  for (const double l : length) sector.push_back(2 * half_sector(l, radius));
  for (std::size_t i = 0; i < sector.size(); ++i) others += i == longest ? 0 : sector[i];
  sector[longest] = sweep - others;
  return sector;
}

double closed_radius(In<double> length, std::size_t longest) {
  const double shortest_radius = 0.5 * length[longest];
  if (half_sweep(length, longest, false, shortest_radius) >= kPi) {
    double sum = 0;
    for (const double l : length) sum += l;
    return root_of_falling(shortest_radius, std::max(shortest_radius, 0.25 * sum),
                           [&](double r) { return half_sweep(length, longest, false, r) - kPi; });
  }
  // The centre lies outside: the others together fill the sector 2 x of the longest edge.
  const auto excess = [&](double x) {
    double sum = 0;
    for (std::size_t i = 0; i < length.size(); ++i) {
      if (i != longest) sum += std::asin(std::min(1.0, length[i] * std::sin(x) / length[longest]));
    }
    return sum - x;
  };
  double lower = 0.25 * kPi;
  while (lower > 1e-9 && excess(lower) <= 0) lower *= 0.5;
  return length[longest] / (2 * std::sin(root_of_falling(lower, 0.5 * kPi, excess)));
}

double arc_radius(In<double> length, std::size_t longest, double sweep) {
  const double shortest_radius = 0.5 * length[longest];
  double sum = 0;
  for (const double l : length) sum += l;
  const bool reflex = half_sweep(length, longest, false, shortest_radius) < 0.5 * sweep;
  const double most = 2 * std::max(shortest_radius, sum / sweep);
  if (!reflex) {
    return root_of_falling(shortest_radius, most,
                           [&](double r) { return half_sweep(length, longest, false, r) - 0.5 * sweep; });
  }
  double upper = most;
  const auto missing = [&](double r) { return 0.5 * sweep - half_sweep(length, longest, true, r); };
  for (int i = 0; i < kBisections && missing(upper) > 0; ++i) upper *= 2;
  return missing(upper) > 0 ? 0 : root_of_falling(shortest_radius, upper, missing);
}

}  // namespace

std::optional<CyclicPolygon> cyclic_polygon(In<double> length) {
  const std::size_t longest = longest_of(length);
  double others = 0;
  for (std::size_t i = 0; i < length.size(); ++i) others += i == longest ? 0 : length[i];
  if (length.size() < 3 || !(others > length[longest])) return std::nullopt;
  CyclicPolygon polygon{.radius = closed_radius(length, longest), .corner = {}};
  double angle = 0;
  for (const double sector : sectors(length, longest, polygon.radius, 2 * kPi)) {
    polygon.corner.push_back(polygon.radius * unit(angle));
    angle += sector;
  }
  return polygon;
}

std::optional<CyclicPolygon> cyclic_arc(In<double> length, double sweep) {
  const std::size_t longest = longest_of(length);
  CyclicPolygon arc{.radius = arc_radius(length, longest, sweep), .corner = {Vec2{}}};
  if (!(arc.radius > 0)) return std::nullopt;
  // Chord by chord: a flat arc's centre may lie too far away to measure from.
  double angle = 0;
  for (const double sector : sectors(length, longest, arc.radius, sweep)) {
    const double chord = 2 * arc.radius * std::sin(0.5 * sector);
    arc.corner.push_back(arc.corner.back() + chord * unit(angle + 0.5 * sector));
    angle += sector;
  }
  return arc;
}

}  // namespace planish
