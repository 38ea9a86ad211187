// The kinds of sample: a plane domain, and how it lies in space.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/sample/panels.hpp"
#include "engine/sample/rows.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// A kind before it has a size.
struct Shape {
  RowDomain domain;
  /// Chart to space; empty for developables, which bend() makes for a number of strips.
  std::function<Vec3(Vec2)> surface;
  std::vector<SampleFeature> features;
  std::vector<SampleConstraint> constraints;
};

Shape hood_shape();
Shape fender_shape();
Shape door_shape();
Shape sphere_cap_shape();
Shape annulus_shape();

/// Straight lines that sheets are bent along: flat [strips + 1] in the unrolled plane and bent in space, so
/// that neighbouring rulings are coplanar and lie to one another as in the plane, up to rounding.
struct Rulings {
  struct Ruling {
    Vec2 flat, flat_direction;
    Vec3 bent, bent_direction, normal;
  };
  std::vector<Ruling> ruling;
  double length = 0;  ///< of each
};

/// A point of the unrolled sheet, on the bent one: strips stay plane.
Vec3 bent_point(const Rulings& sheet, Vec2 flat);

/// A developable kind: the domain that its number of strips is planned by, then the sheet of so many strips.
struct Developable {
  RowDomain smooth;
  std::function<Rulings(Index strips)> bend;
  /// Features of the sheet.
  std::function<void(const Rulings&, Sample&)> mark;
};

Developable cylinder_sheet();
Developable cone_sheet();
Developable tangent_sheet();

/// `count` points of a curve over [0, 1], ends included (closed: the last one left out).
template <class Curve>
std::vector<Vec3> trace(Curve&& curve, Index count, bool closed = false) {
  std::vector<Vec3> points;
  for (Index i = 0; i < count; ++i)
    points.push_back(curve(i / static_cast<double>(closed ? count : count - 1)));
  return points;
}

}  // namespace planish
