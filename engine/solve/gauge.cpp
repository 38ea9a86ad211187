#include "engine/solve/gauge.hpp"

#include <algorithm>
#include <numeric>

namespace planish {
namespace {

struct Triangle {
  Vec2 a, b, c;
};

Triangle image(Index t, In<Index> corner_vertex, In<Vec2> uv) {
  return {uv[corner_vertex[3 * t]], uv[corner_vertex[3 * t + 1]], uv[corner_vertex[3 * t + 2]]};
}

double signed_area(const Triangle& t) { return 0.5 * cross(t.b - t.a, t.c - t.a); }

/// Integral of x^3 over a triangle of area 1 (complete homogeneous polynomial over 10).
double mean_cube(double a, double b, double c) {
  return (a * a * a + b * b * b + c * c * c + a * a * (b + c) + b * b * (a + c) + c * c * (a + b) +
          a * b * c) /
         10;
}

struct Moments {
  double area = 0;
  Vec2 first;                     // integral of z
  double xx = 0, xy = 0, yy = 0;  // second moments about the origin
  double third = 0;               // integral of x^3
};

using ComponentMoments = std::vector<Moments>;

template <class Add>
ComponentMoments accumulate(In<Index> corner_vertex, In<Index> component, Index num_components, In<Vec2> uv,
                            Add add) {
  ComponentMoments moments(num_components);
  for (Index t = 0; t < static_cast<Index>(corner_vertex.size() / 3); ++t) {
    const Triangle triangle = image(t, corner_vertex, uv);
    add(triangle, signed_area(triangle), moments[component[corner_vertex[3 * t]]]);
  }
  return moments;
}

void add_first(const Triangle& t, double area, Moments& m) {
  m.area += area;
  m.first += (area / 3) * (t.a + t.b + t.c);
}

void add_second(const Triangle& t, double area, Moments& m) {
  m.area += area;
  const Vec2 sum = t.a + t.b + t.c;
  m.xx += area / 12 * (sum.x * sum.x + t.a.x * t.a.x + t.b.x * t.b.x + t.c.x * t.c.x);
  m.xy += area / 12 * (sum.x * sum.y + t.a.x * t.a.y + t.b.x * t.b.y + t.c.x * t.c.y);
  m.yy += area / 12 * (sum.y * sum.y + t.a.y * t.a.y + t.b.y * t.b.y + t.c.y * t.c.y);
}

void add_third(const Triangle& t, double area, Moments& m) {
  m.area += area;
  m.xx += area / 12 * (t.a.x * t.a.x + t.b.x * t.b.x + t.c.x * t.c.x);
  m.third += area * mean_cube(t.a.x, t.b.x, t.c.x);
}

constexpr double kTie = 1e-9;  // relative; below it moments are rounding

/// Unit vector of the long axis, up to sign; towards `first` where the moments are isotropic.
Vec2 long_axis(const Moments& m, Vec2 first) {
  const double difference = m.xx - m.yy;
  if (std::hypot(difference, 2 * m.xy) <= kTie * (m.xx + m.yy)) {
    const double length = norm(first);
    return length > 0 ? (1 / length) * first : Vec2{1, 0};
  }
  return unit(0.5 * std::atan2(2 * m.xy, difference));
}

std::vector<Vec2> first_points(In<Index> component, Index num_components, In<Index> vertex_rank,
                               In<Vec2> uv) {
  std::vector<Index> first(num_components, kNone);
  for (Index v = 0; v < static_cast<Index>(uv.size()); ++v) {
    Index& f = first[component[v]];
    if (f == kNone || vertex_rank[v] < vertex_rank[f]) f = v;
  }
  std::vector<Vec2> point(num_components);
  for (Index k = 0; k < num_components; ++k) point[k] = uv[first[k]];
  return point;
}

template <class Move>
void move_components(In<Index> component, Out<Vec2> uv, Move move) {
  for (std::size_t v = 0; v < uv.size(); ++v) uv[v] = move(component[v], uv[v]);
}

}  // namespace

void centre_and_align(In<Index> corner_vertex, const PlacedComponents& components, In<Index> vertex_rank,
                      Out<Vec2> uv) {
  const In<Index> component = components.of;
  const Index num_components = components.size();
  const auto first = accumulate(corner_vertex, component, num_components, uv, add_first);
  move_components(component, uv, [&](Index k, Vec2 z) {
    return first[k].area != 0 && !components.pinned[k] ? z - (1 / first[k].area) * first[k].first : z;
  });
  const auto may_turn = [&](Index k) { return !components.directed[k] && !components.pinned[k]; };
  const auto second = accumulate(corner_vertex, component, num_components, uv, add_second);
  auto towards = first_points(component, num_components, vertex_rank, uv);
  std::vector<Vec2> turn(num_components, {1, 0});
  for (Index k = 0; k < num_components; ++k) {
    if (may_turn(k)) turn[k] = conjugate(long_axis(second[k], towards[k]));
  }
  move_components(component, uv, [&](Index k, Vec2 z) { return may_turn(k) ? multiply(turn[k], z) : z; });

  const auto third = accumulate(corner_vertex, component, num_components, uv, add_third);
  towards = first_points(component, num_components, vertex_rank, uv);
  std::vector<double> sign(num_components, 1);
  for (Index k = 0; k < num_components; ++k) {
    const Moments& m = third[k];
    const double scale = std::pow(std::abs(m.xx), 1.5) / std::sqrt(std::max(std::abs(m.area), 1e-300));
    const double decides = std::abs(m.third) > kTie * scale ? m.third : towards[k].x;
    sign[k] = decides < 0 && may_turn(k) ? -1 : 1;
  }
  move_components(component, uv, [&](Index k, Vec2 z) { return sign[k] * z; });
}

namespace {

struct Box {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  double width() const { return upper.x - lower.x; }
  double height() const { return upper.y - lower.y; }
  void add(Vec2 z) {
    lower = {std::min(lower.x, z.x), std::min(lower.y, z.y)};
    upper = {std::max(upper.x, z.x), std::max(upper.y, z.y)};
  }
};

}  // namespace

void lay_out(const PlacedComponents& components, Out<Vec2> uv) {
  const In<Index> component = components.of;
  std::vector<Box> box(components.size());
  Box pinned;
  for (std::size_t v = 0; v < uv.size(); ++v) {
    box[component[v]].add(uv[v]);
    if (components.pinned[component[v]]) pinned.add(uv[v]);
  }
  std::vector<Index> order;
  for (Index k = 0; k < components.size(); ++k) {
    if (!components.pinned[k]) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return box[a].height() > box[b].height(); });

  double widest = 0, tallest = 0, total = 0;
  for (const Index k : order) {
    widest = std::max(widest, box[k].width());
    tallest = std::max(tallest, box[k].height());
    total += box[k].width() * box[k].height();
  }
  const double gap = 0.02 * std::max(widest, tallest);
  const double row_width = std::max(widest, 1.3 * std::sqrt(total));
  std::vector<Vec2> shift(components.size());
  double x = 0, y = 0, row_height = 0, right = 0;
  for (const Index k : order) {
    if (x > 0 && x + box[k].width() > row_width) {
      x = 0;
      y -= row_height + gap;
      row_height = 0;
    }
    shift[k] = Vec2{x, y - box[k].height()} - box[k].lower;
    row_height = std::max(row_height, box[k].height());
    x += box[k].width() + gap;
    right = std::max(right, x - gap);
  }
  const bool any_pinned = order.size() < box.size();
  const Vec2 corner =
      any_pinned ? Vec2{-(pinned.upper.x + gap), -pinned.upper.y} : Vec2{0.5 * right, 0.5 * (y - row_height)};
  move_components(component, uv,
                  [&](Index k, Vec2 z) { return components.pinned[k] ? z : z + shift[k] - corner; });
}

}  // namespace planish
