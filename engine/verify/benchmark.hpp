// The figures of the parameterization benchmark of Shay, Solomon and Stein.
#pragma once

#include "engine/model/flattening.hpp"
#include "engine/prepare/topology.hpp"
#include "engine/verify/overlaps.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// Area of each rest frame.
std::vector<double> rest_areas(const Exec& exec, In<RestFrame> frame);

/// frame [T] in the units of uv;  uv [V];  overlaps: of uv, with these frames' areas
/// Pairs of triangles with a common vertex overlap only in stars that have a flipped triangle or wind around more than once, so
/// only these are looked at.
/// Cost: O(T); the square of the size of such a star.
/// Ref: Shay, Solomon and Stein 2022, Dataset and Benchmark for Mesh Parameterization; its published program.
BenchmarkFigures benchmark_figures(const Exec& exec, In<Index> corner_vertex, const Topology& topology,
                                   In<RestFrame> frame, In<Vec2> uv, const Overlaps& overlaps);

}  // namespace planish
