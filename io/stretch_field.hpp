// The quantity that colours a panel: how far, and to which side, each triangle is from its true size.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/mesh.hpp"
#include "kernels/local/svd2.hpp"

namespace planish {

/// The singular value whose logarithm is larger in magnitude, minus 1: -0.1 is 10% too short. Triangles
/// without area at rest count as stretched without bound.
double stretch_deviation(SingularValues sigma);

struct StretchField {
  std::vector<float> value;  ///< [T] deviation / limit, cut to [-1, 1]; kFlippedValue of flipped ones
  double limit = 0;  ///< smallest of 1, 2, 3, 4, 5, 6, 8 times a power of ten, 1e-4 to 1, that holds 99% of
                     ///< the rest area of the triangles that are not flipped
};

/// flipped: ids of flipped triangles.   Fails: never for indices in range.
/// Cost: O(T).
StretchField stretch_field(const Exec& exec, const Surface& surface, In<Vec2> uv, In<Index> flipped);

}  // namespace planish
