// The flow of random simple polygons to lines and circles: lengths kept, targets reached, whatever the step.
#include "engine/deform/curve_flow.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/constraints/cyclic_polygon.hpp"
#include "engine/constraints/fit.hpp"
#include "tests/support/check_property.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

using Curve = std::vector<Vec2>;

std::vector<double> lengths(const Curve& curve, bool closed) {
  std::vector<double> result;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < curve.size(); ++i)
    result.push_back(norm(curve[(i + 1) % curve.size()] - curve[i]));
  return result;
}

double total(const std::vector<double>& length) { return std::accumulate(length.begin(), length.end(), 0.0); }

/// A straight line of edges of these lengths, or a circle, counter-clockwise.
Curve target_with(const std::vector<double>& length, bool closed) {
  if (closed) {
    const auto polygon = cyclic_polygon(length);
    RC_PRE(polygon.has_value());  // no edge as long as all others together
    return polygon->corner;
  }
  Curve line = {Vec2{}};
  for (const double l : length) line.push_back(line.back() + Vec2{l, 0});
  return line;
}

/// A random simple polygon; flatness scales its height.
struct Polygon {
  std::uint64_t seed = 0;
  int edges = 3;
  bool closed = false, reversed = false;
  double flatness = 1;

  /// Turns of edges close a flat needle along itself by their squares alone.
  double allowed() const { return flatness < 0.1 ? 1e-10 : 1e-12; }

  /// Closed: star-shaped; open: from left to right.
  Curve corners() const {
    shapes::Random random(seed);
    Curve curve;
    double along = 0;
    std::vector<double> gap;
    for (int i = 0; i < edges; ++i) gap.push_back(0.2 + random.uniform());
    const double sum = total(gap);
    for (int i = 0; i < edges + (closed ? 0 : 1); ++i) {
      const double wide = 0.6 + 0.4 * random.uniform();
      curve.push_back(closed ? wide * unit(2 * kPi * along / sum) : Vec2{along / sum, wide / edges});
      if (i < edges) along += gap[i];
    }
    for (Vec2& z : curve) z.y *= flatness;
    if (reversed) std::reverse(curve.begin(), curve.end());
    return curve;
  }
  /// Of the same lengths: a straight line, or a circle that runs the same way round.
  Curve target(double stretch = 1) const {
    std::vector<double> length = lengths(corners(), closed);
    for (std::size_t i = 0; i < length.size(); ++i) length[i] *= i % 2 == 0 ? stretch : 1;
    Curve curve = target_with(length, closed);
    if (closed && reversed) {
      for (Vec2& z : curve) z = conjugate(z);
    }
    return curve;
  }
};

/// A spiral from the inside out; closed: the outline of a strip along it, counter-clockwise.
Curve spiral(int edges, double turns, bool closed) {
  const auto at = [&](int i, int count, double wide) {
    const double angle = 2 * kPi * turns * i / count;
    return (1 + 0.1 * angle + wide) * unit(angle);
  };
  Curve curve;
  const int along = closed ? edges / 2 : edges;
  for (int i = 0; i <= along; ++i) curve.push_back(at(i, along, closed ? 0.2 : 0));
  for (int i = along; closed && i >= 0; --i) curve.push_back(at(i, along, 0));
  return curve;
}

std::ostream& operator<<(std::ostream& out, const Polygon& p) {
  return out << "seed " << p.seed << ", " << p.edges << " edges, closed " << p.closed << ", reversed "
             << p.reversed << ", flatness " << p.flatness;
}

rc::Gen<Polygon> polygons(bool closed) {
  return rc::gen::withSize([=](int) {
    return rc::gen::map(
        rc::gen::tuple(rc::gen::resize(100, rc::gen::arbitrary<std::uint32_t>()),
                       rc::gen::element(3, 4, 5, 7, 20, 111, 1000, 10'000), rc::gen::arbitrary<bool>(),
                       rc::gen::element(1.0, 1.0, 0.1, 1e-3, 1e-6)),
        [=](const std::tuple<std::uint32_t, int, bool, double>& t) {
          return Polygon{std::get<0>(t), std::get<1>(t), closed, std::get<2>(t), std::get<3>(t)};
        });
  });
}

double worst_length(const Curve& curve, const std::vector<double>& wanted, bool closed) {
  const std::vector<double> now = lengths(curve, closed);
  double worst = 0;
  for (std::size_t i = 0; i < now.size(); ++i) worst = std::max(worst, std::abs(now[i] - wanted[i]));
  return worst / total(wanted);
}

/// After the best isometry, over the length.
double distance(const Curve& curve, const Curve& other) {
  const Placement placement = best_placement(curve, other, 1);
  double worst = 0;
  for (std::size_t i = 0; i < curve.size(); ++i)
    worst = std::max(worst, norm(placement.p + multiply(placement.c, curve[i]) - other[i]));
  return worst / total(lengths(other, false));
}

void keeps_lengths(const Polygon& p) {
  const Curve from = p.corners(), to = p.target();
  const std::vector<double> length = lengths(from, p.closed);
  for (const double step : {1e-3, 0.1, 0.5, 0.9, 1.0})
    RC_ASSERT(worst_length(flow_curve(from, to, p.closed, step), length, p.closed) < p.allowed());
}

void reaches_target(const Polygon& p) {
  const Curve from = p.corners(), to = p.target();
  RC_ASSERT(flow_curve(from, to, p.closed, 1) == to);
  Curve curve = from;
  for (int step = 0; step < 45; ++step) curve = flow_curve(curve, to, p.closed, 0.6);
  RC_ASSERT(distance(curve, to) < 1e-9);
}

}  // namespace

TEST_CASE("curve flow: closed polygons keep their lengths, and stay closed, at every step size") {
  check_property(200, [] { keeps_lengths(*polygons(true)); });
}

TEST_CASE("curve flow: open polygons keep their lengths at every step size") {
  check_property(200, [] { keeps_lengths(*polygons(false)); });
}

TEST_CASE("curve flow: closed polygons become circles, at once by step 1 and in the limit of smaller ones") {
  check_property(60, [] { reaches_target(*polygons(true)); });
}

TEST_CASE("curve flow: open polygons become lines, at once by step 1 and in the limit of smaller ones") {
  check_property(60, [] { reaches_target(*polygons(false)); });
}

TEST_CASE("curve flow: spirals and the outlines of spiral strips unwind, lengths kept, whatever the step") {
  check_property(60, [] {
    const int edges = *rc::gen::element(40, 401, 10'000);
    const double turns = *rc::gen::element(0.7, 2.0, 5.0);
    for (const bool closed : {false, true}) {
      const Curve from = spiral(edges, turns, closed), to = target_with(lengths(from, closed), closed);
      const std::vector<double> length = lengths(from, closed);
      for (const double step : {1e-3, 0.1, 0.5, 0.9, 1.0})
        RC_ASSERT(worst_length(flow_curve(from, to, closed, step), length, closed) < 1e-11);
      Curve curve = from;
      for (int step = 0; step < 45; ++step) curve = flow_curve(curve, to, closed, 0.6);
      RC_ASSERT(distance(curve, to) < 1e-9);
    }
  });
}

TEST_CASE("curve flow: lengths go to the target's by the same step as the turning angles") {
  check_property(100, [] {
    const Polygon p = *polygons(*rc::gen::arbitrary<bool>());
    const Curve from = p.corners(), to = p.target(1.1);
    const std::vector<double> before = lengths(from, p.closed), after = lengths(to, p.closed);
    for (const double step : {0.25, 0.75}) {
      std::vector<double> wanted;
      for (std::size_t i = 0; i < before.size(); ++i)
        wanted.push_back((1 - step) * before[i] + step * after[i]);
      RC_ASSERT(worst_length(flow_curve(from, to, p.closed, step), wanted, p.closed) < p.allowed());
    }
  });
}

TEST_CASE("curve flow: turning angles of open curves go the step's share of their way") {
  const Polygon p{7, 100, false, false, 1};
  const Curve from = p.corners(), to = p.target(), half = flow_curve(from, to, false, 0.5);
  const auto turning = [](const Curve& c, std::size_t i) {
    return argument(multiply(c[i + 1] - c[i], conjugate(c[i] - c[i - 1])));
  };
  for (std::size_t i = 1; i + 1 < from.size(); ++i)
    CHECK(turning(half, i) == doctest::Approx(0.5 * turning(from, i)).epsilon(1e-9));
}

TEST_CASE("curve flow: a small step moves little") {
  check_property(100, [] {
    const Polygon p = *polygons(true);
    constexpr double kStep = 1e-7;
    const Curve from = p.corners();
    RC_ASSERT(distance(flow_curve(from, p.target(), true, kStep), from) < 100 * kStep);
  });
}

TEST_CASE("curve flow: a curve that runs the wrong way round ends on the target nevertheless") {
  const Polygon p{3, 50, true, false, 1};
  Curve mirrored = p.target();
  for (Vec2& z : mirrored) z = conjugate(z);
  Curve curve = p.corners();
  const std::vector<double> length = lengths(curve, true);
  for (const double step : {0.2, 0.25, 1.0 / 3, 0.5, 1.0}) {
    curve = flow_curve(curve, mirrored, true, step);
    CHECK(worst_length(curve, length, true) < 1e-12);
  }
  CHECK(curve == mirrored);
}

TEST_CASE("curve flow: an edge without length goes on as the one before it") {
  const Curve from = {{0, 0}, {1, 0}, {1, 0}, {1, 1}}, to = {{0, 0}, {1, 0}, {2, 0}, {3, 0}};
  const Curve half = flow_curve(from, to, false, 0.5);
  CHECK(worst_length(half, {1, 0.5, 1}, false) < 1e-15);
}
