#include "engine/deform/curve_flow.hpp"

#include <algorithm>
#include <cmath>

namespace planish {
namespace {

/// A curve as its edges: lengths and directions, radians.
struct Edges {
  std::vector<double> length, angle;
};

std::vector<Vec2> edge_vectors(In<Vec2> corner, bool closed) {
  std::vector<Vec2> edge;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < corner.size(); ++i)
    edge.push_back(corner[(i + 1) % corner.size()] - corner[i]);
  return edge;
}

/// An edge of no length goes on as the one before it.
Edges edges_of(In<Vec2> corner, bool closed) {
  Edges edges;
  for (const Vec2 d : edge_vectors(corner, closed)) {
    const double length = norm(d);
    edges.length.push_back(length);
    edges.angle.push_back(length > 0 ? argument(d) : edges.angle.empty() ? 0 : edges.angle.back());
  }
  return edges;
}

double turning(const Edges& edges, std::size_t i) {
  return argument(multiply(unit(edges.angle[i]), unit(-edges.angle[i - 1])));
}

Edges step_between(const Edges& from, const Edges& to, double step) {
  Edges edges = from;
  double turned = 0;  // against the first edge
  for (std::size_t i = 0; i < edges.length.size(); ++i) {
    if (i > 0) turned += turning(to, i) - turning(from, i);
    edges.length[i] = (1 - step) * from.length[i] + step * to.length[i];
    edges.angle[i] = from.angle[i] + step * turned;
  }
  return edges;
}

Vec2 gap_of(const Edges& edges) {
  Vec2 sum{};
  for (std::size_t i = 0; i < edges.length.size(); ++i) sum += edges.length[i] * unit(edges.angle[i]);
  return sum;
}

/// Turns of least weighted square that close the curve to first order: each edge by its normal times a multiplier.
/// The damping, relative to the length, keeps turns small where all edges are nearly parallel.
Vec2 multiplier(const Edges& edges, Vec2 gap, double damping) {
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < edges.length.size(); ++i) {
    const Vec2 t = unit(edges.angle[i]);
    xx += edges.length[i] * t.y * t.y;
    xy -= edges.length[i] * t.x * t.y;
    yy += edges.length[i] * t.x * t.x;
  }
  const double shift = damping * (xx + yy);
  xx += shift, yy += shift;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 0)) return {};
  return {-(yy * gap.x - xy * gap.y) / determinant, -(xx * gap.y - xy * gap.x) / determinant};
}

Edges turned_by(const Edges& edges, Vec2 multiplier) {
  constexpr double kLargestTurn = 0.3;
  Edges turned = edges;
  double largest = 0;
  for (std::size_t i = 0; i < edges.angle.size(); ++i) {
    const Vec2 t = unit(edges.angle[i]);
    turned.angle[i] = dot({-t.y, t.x}, multiplier);
    largest = std::max(largest, std::abs(turned.angle[i]));
  }
  const double share = largest > kLargestTurn ? kLargestTurn / largest : 1;
  for (std::size_t i = 0; i < edges.angle.size(); ++i)
    turned.angle[i] = edges.angle[i] + share * turned.angle[i];
  return turned;
}

/// Newton steps, damped as far as they need it to narrow the gap.
void close(Edges& edges) {
  constexpr int kMostSteps = 200;
  constexpr double kClosed = 1e-15, kLeastDamping = 1e-12, kMostDamping = 1e3;
  double length = 0;
  for (const double l : edges.length) length += l;
  Vec2 gap = gap_of(edges);
  double damping = 0;
  for (int step = 0; step < kMostSteps && norm(gap) > kClosed * length && damping < kMostDamping; ++step) {
    Edges turned = turned_by(edges, multiplier(edges, gap, damping));
    const Vec2 left = gap_of(turned);
    if (norm(left) < norm(gap)) {
      edges = std::move(turned);
      gap = left;
      damping = damping > kLeastDamping ? 0.1 * damping : 0;
    } else {
      damping = std::max(10 * damping, kLeastDamping);
    }
  }
}

/// Corners from the edges one after the other; what is left of the gap, rounding in all but degenerate cases, is spread.
std::vector<Vec2> corners_of(const Edges& edges, bool closed) {
  std::vector<Vec2> corner = {Vec2{}};
  double length = 0;
  for (const double l : edges.length) length += l;
  const Vec2 gap = closed && length > 0 ? (1 / length) * gap_of(edges) : Vec2{};
  for (std::size_t i = 0; i < edges.length.size(); ++i)
    corner.push_back(corner.back() + edges.length[i] * (unit(edges.angle[i]) - gap));
  if (closed) corner.pop_back();
  return corner;
}

}  // namespace

std::vector<Vec2> flow_curve(In<Vec2> from, In<Vec2> to, bool closed, double step) {
  if (step >= 1) return {to.begin(), to.end()};
  Edges edges = step_between(edges_of(from, closed), edges_of(to, closed), step);
  if (closed) close(edges);
  return corners_of(edges, closed);
}

}  // namespace planish
