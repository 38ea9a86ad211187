// Hood, fender and door of a passenger car, in metres: x to the rear, y to the right, z up.
#include <algorithm>
#include <cmath>

#include "engine/sample/shapes.hpp"

namespace planish {
namespace {

double square(double a) { return a * a; }
double mix(double a, double b, double t) { return a + (b - a) * t; }

/// max(x, 0) with a rounded corner: how a press forms a crease.
double bent(double x, double radius) { return (x + std::sqrt(x * x + radius * radius)) / 2; }

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

constexpr Index kTracePoints = 129;
constexpr double kCreaseRadius = 0.008;

// ---- hood ----

double hood_crease(double x) { return 0.34 + 0.08 * x; }

Vec3 hood_surface(Vec2 p) {
  const double crown = 0.92 + 0.10 * p.x - 0.06 * square(p.x) - 0.06 * square(p.y);
  const double nose = 0.9 * square(bent(-0.30 - p.x, 0.05));
  const double bulge = 0.17 * bent(std::abs(p.y) - hood_crease(p.x), kCreaseRadius);
  return {p.x, p.y, crown - nose - bulge};
}

/// Rows run from the nose to the windscreen.
Vec2 hood_chart(double u, double v) {
  const double side = 2 * v - 1;
  const double nose = -0.55 - 0.10 * (1 - square(side)), cowl = 0.68 - 0.10 * (1 - square(side));
  return {mix(nose, cowl, u), mix(0.60, 0.71, std::sin(kPi / 2 * u)) * side};
}

// ---- fender ----

constexpr Vec2 kWheel{0, 0.33};
constexpr double kArchRadius = 0.36, kFlange = 0.028, kFlangeRadius = 0.008, kFlangeBend = 1.4;
constexpr double kArchFront = 165 * kPi / 180, kArchRear = -15 * kPi / 180;

Vec2 around_wheel(double angle, double radius) { return kWheel + radius * unit(angle); }
double fender_crease(double x) { return 0.755 + 0.03 * x; }

/// How far the fender stands out from the middle of the car.
double fender_width(Vec2 p) {
  const double crown = 0.86 - 0.12 * square(p.x + 0.05) - 0.20 * square(p.y - 0.6);
  const double front = 0.9 * square(bent(-0.30 - p.x, 0.05));
  const double shoulder = 0.5 * bent(p.y - fender_crease(p.x), kCreaseRadius);
  const double flare = 0.018 * std::exp(-square((norm(p - kWheel) - kArchRadius) / 0.05));
  return crown - front - shoulder + flare;
}

/// Left fender; what the chart has inside the arch is the flange, bent towards the wheel house.
Vec3 fender_surface(Vec2 p) {
  const double inside = kArchRadius - norm(p - kWheel);
  if (inside <= 0) return {p.x, -fender_width(p), p.y};
  const Vec2 radial = (1 / norm(p - kWheel)) * (p - kWheel);
  const Vec2 lip = kWheel + kArchRadius * radial;
  const double bend = std::min(inside / kFlangeRadius, kFlangeBend), rest = inside - bend * kFlangeRadius;
  const double inwards = kFlangeRadius * std::sin(bend) + rest * std::cos(bend);
  const double inboard = kFlangeRadius * (1 - std::cos(bend)) + rest * std::sin(bend);
  const Vec2 q = lip - inwards * radial;
  return {q.x, -(fender_width(lip) - inboard), q.y};
}

/// The outline seen from the wheel: bumper, hood and door gaps with rounded corners.
double fender_outline(double angle) {
  constexpr double kRoundness = 5;
  const Vec2 d = unit(angle);
  const double reach = d.x < 0 ? 0.66 : 0.58, height = 0.50;
  return std::pow(std::pow(std::abs(d.x) / reach, kRoundness) + std::pow(std::abs(d.y) / height, kRoundness),
                  -1 / kRoundness);
}

/// Rows run around the wheel arch.
Vec2 fender_chart(double u, double v) {
  const double angle = mix(kArchFront, kArchRear, u);
  return around_wheel(angle, mix(kArchRadius - kFlange, fender_outline(angle), v));
}

// ---- door ----

constexpr Vec2 kHandle{0.82, 0.695};
double door_crease(double x) { return 0.75 + 0.05 * x; }

/// 1 on the rim of the handle's recess.
double handle_distance(Vec2 p) { return norm(Vec2{(p.x - kHandle.x) / 0.10, (p.y - kHandle.y) / 0.045}); }

Vec3 door_surface(Vec2 p) {
  const double crown = 0.88 - 0.05 * square(p.x - 0.5) - 0.30 * square(p.y - 0.62);
  const double tuck = 1.2 * square(bent(0.36 - p.y, 0.03));
  const double shoulder = 0.30 * bent(p.y - door_crease(p.x), kCreaseRadius);
  const double swage = 0.012 * std::exp(-square((p.y - 0.40 - 0.04 * p.x) / 0.035));
  const double recess = 0.014 * (1 - smooth_step((handle_distance(p) - 0.4) / 0.6));
  return {p.x, -(crown - tuck - shoulder + swage - recess), p.y};
}

/// Rows run from the hinges to the lock.
Vec2 door_chart(double u, double v) {
  const double x = mix(0.04 * square(1 - v), 1.02 + 0.05 * std::sin(kPi * v), u);
  const double sill = 0.22 + 0.06 * square(std::max(0.0, u - 0.7) / 0.3), belt = 0.88 + 0.05 * u;
  return {x, mix(sill, belt, v)};
}

}  // namespace

Shape hood_shape() {
  Shape hood{{RowShape::Open, hood_chart}, hood_surface, {}, {}};
  const auto crease = [](double side) {
    return trace(
        [side](double s) {
          const double x = mix(-0.55, 0.55, s);
          return hood_surface({x, side * hood_crease(x)});
        },
        kTracePoints);
  };
  const auto straight = [](Vec2 from, Vec2 to) {
    return trace([=](double s) { return hood_surface(from + s * (to - from)); }, kTracePoints);
  };
  hood.features = {{"crease_left", crease(-1)},
                   {"crease_right", crease(1)},
                   {"centre_line", straight({-0.60, 0}, {0.53, 0})},
                   {"cross_line", straight({0.05, -0.27}, {0.05, 0.27})}};
  hood.constraints = {{"line", {"crease_left"}, {}},
                      {"line", {"crease_right"}, {}},
                      {"line", {"centre_line"}, {}},
                      {"line", {"cross_line"}, {}},
                      {"perpendicular", {"centre_line", "cross_line"}, {}}};
  return hood;
}

Shape fender_shape() {
  Shape fender{{RowShape::Open, fender_chart}, fender_surface, {}, {}};
  const auto arch = [](double s) {
    constexpr double kEnds = 0.05;
    return fender_surface(around_wheel(mix(kArchFront - kEnds, kArchRear + kEnds, s), kArchRadius));
  };
  const auto character_line = [](double s) {
    const double x = mix(-0.48, 0.42, s);
    return fender_surface({x, fender_crease(x)});
  };
  fender.features = {{"wheel_arch", trace(arch, kTracePoints)},
                     {"character_line", trace(character_line, kTracePoints)}};
  fender.constraints = {{"circle", {"wheel_arch"}, {}}, {"line", {"character_line"}, {}}};
  return fender;
}

Shape door_shape() {
  Shape door{{RowShape::Open, door_chart}, door_surface, {}, {}};
  const auto character_line = [](double s) {
    const double x = mix(0.06, 0.99, s);
    return door_surface({x, door_crease(x)});
  };
  const auto handle = [](double s) {
    const Vec2 d = unit(2 * kPi * s);
    return door_surface(kHandle + Vec2{0.105 * d.x, 0.047 * d.y});
  };
  door.features = {{"character_line", trace(character_line, kTracePoints)},
                   {"handle_recess", trace(handle, kTracePoints - 1, true), true}};
  door.constraints = {{"line", {"character_line"}, {}}, {"curve", {"handle_recess"}, {}}};
  return door;
}

}  // namespace planish
