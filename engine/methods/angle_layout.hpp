// From the angles of flat triangles to their places in the plane.
#pragma once

#include <algorithm>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// How far angles are from those of a flat map.
struct AngleDefects {
  double triangle = 0;  ///< largest |sum - pi| of a triangle, radians
  double vertex = 0;    ///< largest |sum - 2 pi| around an interior vertex, radians
  double wheel = 0;     ///< largest |log of the product of length ratios| around an interior vertex
  double largest() const { return std::max({triangle, vertex, wheel}); }
};

/// angle [3 T] at each corner, radians.   Cost: O(T), parallel.
AngleDefects angle_defects(const Exec& exec, const Topology& topology, In<double> angle);

/// The map whose triangles have given angles, its components of given areas. Directions and lengths are carried from triangle
/// to triangle; then positions are fitted to all edges by least squares of what each edge misses relative to its length, so
/// that what does not close is spread out. Where angles close, the fit is exact.
///   angle [3 T] radians, in (0, pi);  order: fill-reducing, of all vertices;  area: per component, > 0
///   result [V]: in each component the first vertex lies at the origin
/// Fails: as GlobalPhase::factor().   Cost: one factorization of the size of the global phase.
/// Ref: Sheffer et al. 2005, section 4, whose least squares are over angles of known shape; here edges, their frames known.
Result<std::vector<Vec2>> lay_out_angles(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                         In<double> angle, In<Index> order, In<double> area);

}  // namespace planish
