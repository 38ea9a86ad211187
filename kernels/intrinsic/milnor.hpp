// Milnor's Lobachevsky function, and the corner angles of triangles of given logarithmic edge lengths.
#pragma once

#include <array>

namespace planish {

/// Lobachevsky function L(x) = -integral of log |2 sin t| from 0 to x: odd, of period pi, 0 at multiples of pi / 2.
/// Error below 1e-15.   Ref: Milnor 1982; as half the Clausen function of 2 x, by its series about 0 and pi.
double lobachevsky(double x);

/// Angles of a triangle whose edges have these logarithms of their lengths, edge i opposite corner i.
/// Where the edges make no triangle, pi opposite the longest one and 0 at the others: the extension of Springborn et al. 2008.
struct TriangleAngles {
  std::array<double, 3> angle = {};
  bool broken = false;  ///< the longest edge is as long as the two others together, or longer
};
TriangleAngles triangle_angles(const std::array<double, 3>& log_length);

}  // namespace planish
