// The local phase as the engine runs it: rotations, energy and forces in one pass over the triangles.
#pragma once

#include <vector>

#include "engine/solve/star_blocks.hpp"
#include "kernels/intrinsic/lengths.hpp"

namespace planish {

/// The ARAP energy of a mesh: sum over triangles of A |J - R|_F^2 with R the closest rotation (Liu et al.
/// 2008).
struct ArapEnergy {
  In<Index> corner_vertex;  ///< [3 T]
  Offsets stars;            ///< [V] corners at each vertex
  In<Index> star_corner;    ///< [3 T]
  In<RestFrame> frame;      ///< [T]
  In<double> cotangent;     ///< [3 T]
  In<std::uint8_t> fixed;   ///< [V] 1 for the vertex of each component that holds it in place
  double area = 0;          ///< sum of the rest areas
  Index num_vertices() const { return stars.size(); }
  Index num_triangles() const { return static_cast<Index>(frame.size()); }
};

class LocalPhase {
 public:
  LocalPhase(const Exec& exec, const ArapEnergy& energy);

  /// Energy (not divided by the area) at uv [V]; force [V] out: half its gradient, 0 at fixed vertices.
  double evaluate(In<Vec2> uv, Out<Vec2> force);

  /// Forces at uv [V] against given rotations [T].
  void evaluate_rotations(In<Vec2> uv, In<Vec2> rotation, Out<Vec2> force);

 private:
  /// triangles(Range, Out): energy of a block, and the forces of its corners.
  template <class Triangles>
  double sweep(Triangles triangles, Out<Vec2> force);

  const Exec& exec_;
  ArapEnergy energy_;
  StarBlocks blocks_;
  std::vector<Index> held_;  // vertices that are fixed
  std::vector<Vec2> kept_;   // forces of corners at shared vertices
};

}  // namespace planish
