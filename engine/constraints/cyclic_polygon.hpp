// Polygons with given edge lengths whose corners lie on one circle.
#pragma once

#include <optional>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// A cyclic polygon or polyline, counter-clockwise, around the origin or (arcs) near it.
struct CyclicPolygon {
  double radius = 0;
  std::vector<Vec2> corner;
};

/// The closed polygon with these edge lengths, edge i from corner i to corner i + 1. Exists and is unique where no
/// edge is as long as all others together; else none.   length [n >= 3] > 0
/// Cost: some 60 sweeps over the edges.   Ref: DESIGN 3.2, centre inside or outside; the paper's angle formula is its
/// limit for small edges.
std::optional<CyclicPolygon> cyclic_polygon(In<double> length);

/// The polyline with these edge lengths on a circle, turning left, whose ends are seen from the centre under `sweep`
/// radians, in (0, 2 pi). None where the edges do not allow it.   length [n >= 1] > 0; n + 1 corners
std::optional<CyclicPolygon> cyclic_arc(In<double> length, double sweep);

}  // namespace planish
