// Cotangent weights, with needles kept from poisoning them.
#pragma once

#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// Least ratio of a triangle's altitude to its longest edge in the weights; flatter triangles get the
/// cotangents of the triangle with its apex lifted to that altitude. The weights stay those of a real
/// triangle, so they stay positive semidefinite, and an isometric map still has energy 0.
inline constexpr double kLeastAltitude = 1e-5;

/// Cotangents at the three corners.
struct Cotangents {
  std::array<double, 3> at;
  bool mollified = false;
};
Cotangents cotangents(const RestFrame& frame);

/// Weight of the edge of half-edge c: half the sum of the cotangents opposite.   twin: of c, kNone on a boundary
inline double edge_cotangent(In<double> cotangent, Index c, Index twin) {
  return 0.5 * (cotangent[previous_corner(c)] + (twin == kNone ? 0 : cotangent[previous_corner(twin)]));
}

///   frame [T] length;  cotangent [3 T] out, at each corner;  mollified [T] out: 1 where the altitude was
///   floored.
void cotangents(Range triangles, In<RestFrame> frame, Out<double> cotangent, Out<std::uint8_t> mollified);

}  // namespace planish
