#include "kernels/local/contact.hpp"

#include <algorithm>

namespace planish {
namespace {

constexpr std::array<double, 3> kSpin{0, -1, 1};

/// s u v^T
Mat2 outer(double s, Vec2 u, Vec2 v) { return {s * u.x * v.x, s * u.x * v.y, s * u.y * v.x, s * u.y * v.y}; }

void add(Mat2& sum, const Mat2& m) {
  sum.m00 += m.m00;
  sum.m01 += m.m01;
  sum.m10 += m.m10;
  sum.m11 += m.m11;
}

/// Symmetric 2x2 matrix [[xx, xy], [xy, yy]].
struct Symmetric2 {
  double xx = 0, xy = 0, yy = 0;
};

Symmetric2 positive_part(const Symmetric2& m) {
  const double mean = 0.5 * (m.xx + m.yy), half = 0.5 * (m.xx - m.yy), radius = std::hypot(half, m.xy);
  const double high = std::max(0.0, mean + radius), low = std::max(0.0, mean - radius);
  if (radius == 0) return {high, 0, low};
  const double middle = 0.5 * (high + low), spread = 0.5 * (high - low) / radius;
  return {middle + spread * half, spread * m.xy, middle - spread * half};
}

}  // namespace

SegmentDistance segment_distance(Vec2 point, Vec2 a, Vec2 b) {
  const Vec2 edge = b - a, arm = point - a;
  SegmentDistance d;
  d.length = norm(edge);
  const double s = dot(edge, arm) / (d.length * d.length);
  d.at_end = s <= 0 || s >= 1;
  if (d.at_end) {
    const Vec2 from_end = s <= 0 ? arm : point - b;
    d.distance = norm(from_end);
    d.away = (1 / d.distance) * from_end;
    d.share = s <= 0 ? std::array<double, 3>{1, -1, 0} : std::array<double, 3>{1, 0, -1};
  } else {
    const Vec2 left = (1 / d.length) * Vec2{-edge.y, edge.x};
    const double height = dot(left, arm);
    d.distance = std::abs(height);
    d.away = height < 0 ? -left : left;
    d.share = {1, -(1 - s), -s};
  }
  // Along the segment, from a to b, where its line is nearest: away turned by a quarter, one way or the other.
  d.along = d.at_end ? Vec2{-d.away.y, d.away.x} : (1 / d.length) * edge;
  return d;
}

std::array<std::array<Mat2, 3>, 3> contact_hessian(const SegmentDistance& d, double slope, double curvature,
                                                   double projection) {
  // Turning of the segment (x = away . spin) against sliding along it (y = along . share), both lengths.
  Symmetric2 turn;
  if (d.at_end) {
    turn.yy = slope / d.distance;
  } else {
    turn.xx = -slope * d.distance / (d.length * d.length);
    turn.xy = -slope / d.length;
  }
  const Symmetric2 positive = positive_part(turn);
  turn.xx += projection * (positive.xx - turn.xx);
  turn.xy += projection * (positive.xy - turn.xy);
  turn.yy += projection * (positive.yy - turn.yy);
  std::array<std::array<Mat2, 3>, 3> hessian;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Mat2& block = hessian[i][j];
      block = outer(curvature * d.share[i] * d.share[j] + turn.xx * kSpin[i] * kSpin[j], d.away, d.away);
      add(block, outer(turn.yy * d.share[i] * d.share[j], d.along, d.along));
      add(block, outer(turn.xy * kSpin[i] * d.share[j], d.away, d.along));
      add(block, outer(turn.xy * d.share[i] * kSpin[j], d.along, d.away));
    }
  }
  return hessian;
}

double first_contact(const std::array<Vec2, 3>& corner, const std::array<Vec2, 3>& step) {
  const Vec2 edge = corner[2] - corner[1], arm = corner[0] - corner[1];
  const Vec2 edge_step = step[2] - step[1], arm_step = step[0] - step[1];
  // The three are collinear where a t^2 + b t + c = 0.
  const double a = cross(edge_step, arm_step), b = cross(edge, arm_step) + cross(edge_step, arm),
               c = cross(edge, arm);
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0)) return kInfinity;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  double first = kInfinity;
  for (const double t : {q / a, c / q}) {
    if (!(t > 0) || !std::isfinite(t) || t >= first) continue;
    const Vec2 e = edge + t * edge_step, r = arm + t * arm_step;
    constexpr double kSlack = 1e-6;  // rounding must not let a point slip past an end
    const double s = dot(e, r), all = dot(e, e);
    if (s >= -kSlack * all && s <= (1 + kSlack) * all) first = t;
  }
  return first;
}

}  // namespace planish
