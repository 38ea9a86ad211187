// Segments between points, in any order and direction, joined to one polyline.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/model/feature.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// Why segments form no single polyline.
struct ChainFault {
  std::string what;
  std::vector<Index> points;  ///< those to blame, ascending; no more than kMaxListedIds
  Offset count = 0;           ///< number of all of them
  std::size_t segment = 0;    ///< the first one to blame
};

struct ChainOfSegments {
  PolylineSource polyline;
  std::optional<ChainFault> fault;  ///< then the polyline is empty
};

/// Points at exactly equal positions are one. The polyline runs as the first segment does; it is closed when
/// every point has two segments, and then begins at the first segment's begin.
///   point [P] mesh units;  segment [S] pairs of points, at least one, all in range
/// Faults: a segment without length, a point of more than two segments, several pieces, a closed polyline of
/// fewer than three points.
/// Cost: O(S log S); points that no segment names are not looked at.
ChainOfSegments join_segments(In<Vec3> point, In<std::array<Index, 2>> segment);

}  // namespace planish
