// Which sheet of a surface the points of a polyline lie on: carried along the polyline from one of its points.
#pragma once

#include <vector>

#include "engine/features/sheet_search.hpp"
#include "engine/features/surface_locator.hpp"
#include "engine/model/feature.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Length of a polyline, of a closed one with the way back to its first point; mesh units.
double length_of(const PolylineSource& source);

/// A polyline with the closest point of each of its points; the caller's arrays.
struct PolylineHits {
  const PolylineSource* source = nullptr;
  double max_distance = 0;                ///< mesh units
  Out<SurfaceLocator::Hit> nearest = {};  ///< [points]
  Out<std::uint8_t> link = {};            ///< [points] the hits of i and its successor are joined
  Index size() const { return static_cast<Index>(source->point.size()); }
  Index successor(Index i) const { return i + 1 < size() ? i + 1 : 0; }
  /// Segments; the last of a closed one returns to point 0.
  Index num_segments() const { return source->closed ? size() : size() - 1; }
};

/// Whether the closest points of point i and its successor are on one sheet: joined on the surface within the
/// narrowest capsule that their segment is looked at in.   Pre: i in [0, num_segments()).
bool nearest_are_joined(SheetSearch& search, const PolylineHits& polyline, Index i);

/// Hits of all points, on one sheet where there is one to follow. A sheet is carried along the polyline from
/// each run of linked points, the longest first, as many as are worth trying; of these hits and the closest
/// ones the best are those on one component, then those of the least squared distances and breaks.
/// Pre: nearest and link are filled.   Fails: never.
/// Cost: a few times the search of a segment for each point, for each run that is tried.
std::vector<SurfaceLocator::Hit> hits_on_one_sheet(const Surface& surface, const Topology& topology,
                                                   const SurfaceLocator& locator,
                                                   const PolylineHits& polyline);

}  // namespace planish
