// Keys for a locality-keeping order: places along a Hilbert curve through the bounding box.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

inline constexpr int kHilbertBits = 11;  ///< an axis
inline constexpr int kHilbertKeyBits = 3 * kHilbertBits;

/// Place of a cell (each coordinate below 2^kHilbertBits) along the Hilbert curve.
/// Ref: Skilling 2004, Programming the Hilbert curve.
std::uint64_t hilbert_key(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// key [n] of the cells that hold position [n]; the box is a cube from `lower` with edge `extent` > 0.
/// Positions that are not finite count as `lower`.
void hilbert_keys(Range r, Vec3 lower, double extent, In<Vec3> position, Out<std::uint64_t> key);

}  // namespace planish
