// Stars by blocks of triangles, for sums over stars in the same pass as the triangles.
#pragma once

#include <vector>

#include "engine/exec/parallel.hpp"
#include "kernels/base/offsets.hpp"
#include "kernels/local/star_sums.hpp"

namespace planish {

/// A vertex whose triangles all lie in one block is `inner` to it: its sum is complete with the block, while what the
/// corners bring is still near. Corners of the other, shared, vertices are kept until all blocks are done, each at a
/// place of its own, in the order of the star: sums have the same bits as those over stars alone.
struct StarBlocks {
  std::vector<Index> run_begin;      ///< [blocks + 1]
  std::vector<StarRun> run;          ///< inner vertices of each block, those of one degree together
  std::vector<Index> inner;          ///< vertices, by run
  std::vector<std::uint16_t> slot;   ///< corners around each of them, counted from the block's first
  std::vector<Index> shared;         ///< vertices
  std::vector<Index> kept_begin;     ///< [shared + 1] into what is kept
  std::vector<Index> outward_begin;  ///< [blocks + 1]
  std::vector<Index> outward;        ///< corners of shared vertices, by block
  std::vector<Index> place;          ///< [outward] where each is kept

  Index num_kept() const { return kept_begin.back(); }
  In<StarRun> runs_of(Index block) const {
    return slice(In<StarRun>(run), {run_begin[block], run_begin[block + 1]});
  }
  Range outward_of(Index block) const { return {outward_begin[block], outward_begin[block + 1]}; }
};

inline constexpr Index kMostBlockTriangles = 21'845;  ///< whose corners 16 bits count

/// block: triangles in one, at most kMostBlockTriangles. Pre: every vertex is used.
/// Cost: reads the stars; keeps 8 bytes a triangle.
StarBlocks star_blocks(const Exec& exec, In<Index> corner_vertex, Offsets stars, In<Index> star_corner,
                       Index block);

}  // namespace planish
