// Sphere cap and flat ring: closed forms for everything.
#include <cmath>

#include "engine/sample/shapes.hpp"

namespace planish {
namespace {

constexpr Index kCirclePoints = 128;

/// Angle of a ring's parameter: clockwise, so that the chart, outwards across, runs counter-clockwise.
Vec2 ring_direction(double u) { return unit(-2 * kPi * u); }

}  // namespace

Shape sphere_cap_shape() {
  constexpr double kRadius = 0.5, kOpening = 0.9;  // angle from the pole to the rim
  Shape cap;
  // Equidistant from the pole: distances from it are true.
  cap.domain = {RowShape::Rings,
                [](double u, double v) { return kRadius * kOpening * v * ring_direction(u); }};
  cap.surface = [](Vec2 p) {
    const double distance = norm(p), angle = distance / kRadius;
    const double shrink = distance > 0 ? std::sin(angle) / angle : 1;
    return Vec3{shrink * p.x, shrink * p.y, kRadius * std::cos(angle)};
  };
  const auto latitude = [&](double s) { return cap.surface(0.6 * kOpening * kRadius * unit(2 * kPi * s)); };
  cap.features = {{"latitude", trace(latitude, kCirclePoints, true), true}};
  cap.constraints = {{"circle", {"latitude"}, {}}};
  return cap;
}

Shape annulus_shape() {
  constexpr double kInner = 0.4, kOuter = 1.0;
  Shape annulus;
  annulus.domain = {RowShape::Closed,
                    [](double u, double v) { return (kInner + (kOuter - kInner) * v) * ring_direction(u); }};
  annulus.surface = [](Vec2 p) { return Vec3{p.x, p.y, 0}; };
  const auto middle = [](double s) {
    const Vec2 d = 0.7 * unit(2 * kPi * s);
    return Vec3{d.x, d.y, 0};
  };
  annulus.features = {{"middle", trace(middle, kCirclePoints, true), true}};
  annulus.constraints = {{"circle", {"middle"}, {}}};
  return annulus;
}

}  // namespace planish
