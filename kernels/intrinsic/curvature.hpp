// Angle sums of vertex stars; angle defect and boundary turning follow from them.
#pragma once

#include "kernels/base/offsets.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// Sum of the corner angles at each vertex of r: 2 pi - sum is the angle defect inside, pi - sum the boundary
/// turning.
///   angle [3 T] radians;  stars / star_corner: corners at each vertex;  angle_sum [V] out, radians.
void angle_sums(Range r, In<double> angle, Offsets stars, In<Index> star_corner, Out<double> angle_sum);

}  // namespace planish
