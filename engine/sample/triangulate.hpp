// Triangles between rows of points, then edge flips that enlarge the smallest angles: irregular like a
// remeshed scan.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/sample/rows.hpp"
#include "kernels/base/types.hpp"

namespace planish {

struct RowMesh {
  std::vector<Vec2> chart;           ///< [V] rows one after the other
  std::vector<Index> corner_vertex;  ///< [3 T] strips one after the other, counter-clockwise in the chart
};

/// Every strip is triangulated from its undisturbed rows; jitter is then taken back at triangles that it
/// would turn over or flatten, so that all areas in the chart are positive.
/// Cost: O(T), parallel.
RowMesh triangulate_rows(const Exec& exec, const RowDomain& domain, const RowPlan& plan, std::uint64_t seed);

/// Flips edges while that enlarges the smallest of the six angles beside them, measured on the surface;
/// triangles stay positive in the chart. Blocks of strips first, then the seams between blocks.
/// Cost: O(T),
/// parallel.
void flip_to_larger_angles(const Exec& exec, const RowPlan& plan, In<Vec2> chart, In<Vec3> position,
                           std::vector<Index>& corner_vertex);

}  // namespace planish
