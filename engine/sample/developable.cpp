// Cylinder, cone and the tangents of a curve as polyhedra: plane strips that meet along rulings. Triangulated
// with all vertices on rulings they unroll without any error but rounding.
#include <algorithm>
#include <cmath>

#include "engine/sample/shapes.hpp"

namespace planish {
namespace {

constexpr double kMargin = 0.04;  // features stay off the border by this part of the sheet

Vec3 unit3(Vec3 a) { return (1 / norm(a)) * a; }

/// A point of ruling k, `fraction` of its length along it.
Vec3 on_ruling(const Rulings& sheet, Index k, double fraction) {
  return sheet.ruling[k].bent + (fraction * sheet.length) * sheet.ruling[k].bent_direction;
}

SampleFeature ruling_feature(const Rulings& sheet, const std::string& name, Index k) {
  constexpr Index kPoints = 33;
  return {name,
          trace([&](double s) { return on_ruling(sheet, k, kMargin + (1 - 2 * kMargin) * s); }, kPoints),
          false};
}

Index last(const Rulings& sheet) { return static_cast<Index>(sheet.ruling.size()) - 1; }

Index ruling_at(const Rulings& sheet, double part) {
  return static_cast<Index>(std::lround(part * last(sheet)));
}

/// Two rulings as lines at the angle that they have in the unrolled sheet.
void mark_two_rulings(const Rulings& sheet, Sample& sample) {
  const Index a = ruling_at(sheet, 0.25), b = ruling_at(sheet, 0.75);
  const Vec2 da = sheet.ruling[a].flat_direction, db = sheet.ruling[b].flat_direction;
  sample.features = {ruling_feature(sheet, "first_ruling", a), ruling_feature(sheet, "second_ruling", b)};
  sample.constraints = {
      {"line", {"first_ruling"}, {}},
      {"line", {"second_ruling"}, {}},
      {"angle", {"first_ruling", "second_ruling"}, std::atan2(cross(da, db), dot(da, db)) * 180 / kPi}};
}

/// A plane strip's frame in space.
struct Frame {
  Vec3 origin, x{1, 0, 0}, y{0, 1, 0};
  Vec3 direction(Vec2 d) const { return d.x * x + d.y * y; }
  Vec3 point(Vec2 p) const { return origin + direction(p); }
  Vec3 normal() const { return cross(x, y); }
};

Vec3 turned(Vec3 a, Vec3 axis, double angle) {
  return std::cos(angle) * a + std::sin(angle) * cross(axis, a) + (1 - std::cos(angle)) * dot(axis, a) * axis;
}

/// The frame beyond a fold by `angle` along the line through p with direction d.
Frame folded(const Frame& frame, Vec2 p, Vec2 d, double angle) {
  const Vec3 axis = unit3(frame.direction(d)), hinge = frame.point(p);
  Frame next;
  next.x = unit3(turned(frame.x, axis, angle));
  next.y = turned(frame.y, axis, angle);
  next.y = unit3(next.y - dot(next.x, next.y) * next.x);  // rounding must not pile up over thousands of folds
  next.origin = hinge - p.x * next.x - p.y * next.y;
  return next;
}

}  // namespace

Vec3 bent_point(const Rulings& sheet, Vec2 flat) {
  // Rulings run counter-clockwise: a point lies to the left of those before it.
  const auto beyond = [&](const Rulings::Ruling& ruling) {
    return cross(ruling.flat_direction, flat - ruling.flat) >= 0;
  };
  const auto after = std::partition_point(sheet.ruling.begin() + 1, sheet.ruling.end() - 1, beyond);
  const Rulings::Ruling &a = *(after - 1), &b = *after;
  const Vec2 p = flat - a.flat, across = b.flat - a.flat, along = a.flat_direction;
  const double part = cross(along, p) / cross(along, across), rest = dot(p - part * across, along);
  return a.bent + part * (b.bent - a.bent) + rest * a.bent_direction;
}

Developable cylinder_sheet() {
  constexpr double kRadius = 0.5, kSweep = 2.0, kLength = 0.9;
  Developable cylinder;
  cylinder.smooth = {RowShape::Open, [](double u, double v) {
                       return Vec2{kLength * u, kRadius * kSweep * v};
                     }};
  cylinder.bend = [](Index strips) {
    const double turn = kSweep / strips, chord = 2 * kRadius * std::sin(turn / 2);
    Rulings sheet{{}, kLength};
    for (Index k = 0; k <= strips; ++k) {
      // Around the z axis; against the angle, so that the normal points away from the axis.
      const Vec2 d = unit((kPi + kSweep) / 2 - k * turn);
      sheet.ruling.push_back(
          {{0, k * chord}, {1, 0}, {kRadius * d.x, kRadius * d.y, 0}, {0, 0, 1}, {d.x, d.y, 0}});
    }
    return sheet;
  };
  cylinder.mark = [](const Rulings& sheet, Sample& sample) {
    const Index begin = ruling_at(sheet, kMargin) + 1, end = last(sheet) - begin;
    SampleFeature section{"section", {}, false};
    for (Index k = begin; k <= end; ++k) section.points.push_back(on_ruling(sheet, k, 0.5));
    sample.features = {ruling_feature(sheet, "ruling", ruling_at(sheet, 0.5))};
    sample.constraints = {{"line", {"ruling"}, {}}};
    if (section.points.size() < 2) return;  // two strips only
    sample.features.push_back(section);
    sample.constraints.push_back({"line", {"section"}, {}});
    sample.constraints.push_back({"perpendicular", {"ruling", "section"}, {}});
  };
  return cylinder;
}

Developable cone_sheet() {
  constexpr double kHalfAngle = 0.45, kSweep = 2.4, kInner = 0.6, kOuter = 1.5;
  Developable cone;
  cone.smooth = {RowShape::Open, [](double u, double v) {
                   return (kInner + (kOuter - kInner) * u) * unit(kSweep * std::sin(kHalfAngle) * v);
                 }};
  cone.bend = [](Index strips) {
    const double turn = kSweep / strips;
    const double flat_turn = 2 * std::asin(std::sin(kHalfAngle) * std::sin(turn / 2));
    Rulings sheet{{}, kOuter - kInner};
    for (Index k = 0; k <= strips; ++k) {
      const Vec2 flat = unit(k * flat_turn), d = unit(k * turn - kSweep / 2);
      // Apex at the origin, opening downwards: the normal points away from the axis.
      const double r = std::sin(kHalfAngle), h = std::cos(kHalfAngle);
      const Vec3 generator{r * d.x, r * d.y, -h};
      sheet.ruling.push_back({kInner * flat, flat, kInner * generator, generator, {h * d.x, h * d.y, r}});
    }
    return sheet;
  };
  cone.mark = mark_two_rulings;
  return cone;
}

Developable tangent_sheet() {
  // Unrolled: tangents of a circle, from kNear to kFar beyond their points of contact. Bent by kBend in all.
  constexpr double kCircle = 0.35, kSweep = 1.1, kNear = 0.5, kFar = 1.3, kBend = 1.0;
  const auto flat = [](double u, double v) {
    const Vec2 d = unit(kSweep * v);
    const double t = kNear + (kFar - kNear) * u;
    return Vec2{kCircle * d.x - t * d.y, kCircle * d.y + t * d.x};
  };
  Developable tangents;
  tangents.smooth = {RowShape::Open, flat};
  tangents.bend = [flat](Index strips) {
    Rulings sheet{{}, kFar - kNear};
    Frame frame;
    for (Index k = 0; k <= strips; ++k) {
      const double v = static_cast<double>(k) / strips;
      const Vec2 p = flat(0, v), d = multiply({0, 1}, unit(kSweep * v));
      // The strips on both sides see the same line; the first and the last ruling have one side only.
      const Frame next = k == 0 || k == strips ? frame : folded(frame, p, d, -kBend / strips);
      sheet.ruling.push_back(
          {p, d, frame.point(p), frame.direction(d), unit3(frame.normal() + next.normal())});
      frame = next;
    }
    return sheet;
  };
  tangents.mark = mark_two_rulings;
  return tangents;
}

}  // namespace planish
