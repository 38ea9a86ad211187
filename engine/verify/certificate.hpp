// The facts of DESIGN 3.8, measured on a map's coordinates as they are written.
#pragma once

#include "engine/exec/parallel.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// Energies, stretch, flips (exact) and overwound vertices. Ids are those of the arrays given.
///   surface: topology's mesh;  frame [T] in the units of uv;  uv [V].
/// A vertex is overwound when the signed angles of its image fan, flipped triangles counting negative, sum to
/// more than 2 pi. Percentiles are weighted by rest area: the least value that p of the area does not exceed.
/// Overlaps are not looked for.   Cost: O(T log T).
Certificate certify(const Exec& exec, const Surface& surface, const Topology& topology, In<RestFrame> frame,
                    In<Vec2> uv);

}  // namespace planish
