// Neighbourhoods of a map that are mended each on its own, in parallel, while everything around them stays.
#pragma once

#include <vector>

#include "engine/solve/newton_map.hpp"

namespace planish {

/// A set of free vertices, connected unless said otherwise, and the triangles at them.
struct Patch {
  std::vector<Index>
      vertex;  ///< the free ones in order of elimination, then those of the rim, and what else is held
  Index num_free = 0;
  std::vector<Index> triangle;
};

/// Grows the neighbourhoods of seed triangles by rings of edges; what touches is one patch.
///   movable [V]: 1 where a vertex may be free;  rank [V]: place in the fill-reducing order
/// Cost: O(V) for the marks, and the triangles of the patches.
std::vector<Patch> grow_patches(const ArapEnergy& mesh, In<Index> seed_triangle, int rings,
                                In<std::uint8_t> movable, In<Index> rank);

/// The same neighbourhoods as one patch.
Patch grow_patch(const ArapEnergy& mesh, In<Index> seed_triangle, int rings, In<std::uint8_t> movable,
                 In<Index> rank);

/// A patch as a mesh of its own.
class PatchMesh {
 public:
  PatchMesh(const ArapEnergy& mesh, const Patch& patch);
  const ArapEnergy& energy() const { return energy_; }
  ReducedUnknowns unknowns() const;

 private:
  Index num_free_ = 0;
  std::vector<Index> corner_vertex_, star_begin_, star_corner_;
  std::vector<RestFrame> frame_;
  std::vector<double> cotangent_;
  std::vector<std::uint8_t> fixed_;
  ArapEnergy energy_;
};

}  // namespace planish
