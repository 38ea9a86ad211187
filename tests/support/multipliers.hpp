// The first global step as the paper writes it: constraints as linear equations on vertices, Lagrange multipliers, one
// dense system. Shares no code with the solver.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish::multipliers {

/// z_v - z_w = s direction (t_v - t_w) for all of its vertices.
struct DirectedShape {
  std::vector<Index> vertex;
  std::vector<Vec2> shape;      ///< t, one a vertex
  Vec2 direction;               ///< unit complex number
  std::optional<double> scale;  ///< s; none: unknown
  Index scale_group = kNone;    ///< shapes of one group share the unknown
  bool free_lengths = false;    ///< only: z_v - z_w is a real multiple of the direction
};

/// Of one component.
struct Problem {
  In<Vec3> position;        ///< [V]
  In<Index> corner_vertex;  ///< [3 T]
  In<Vec2> rotation;        ///< [T] of the frames with corner 0 at the origin, corner 1 on the x axis
  std::vector<DirectedShape> shapes;
  std::vector<std::pair<Index, Vec2>> pins;  ///< none: vertex 0 is held at the origin
};

struct Solution {
  std::vector<Vec2> z;       ///< [V]
  int equations = 0;         ///< real ones
  int redundant = 0;         ///< of them, those that follow from the others
  double contradiction = 0;  ///< largest amount by which such a one does not, units of the positions
};

/// Minimises 1/2 sum of cot |dz - R dx|^2 under the equations: [L C^T; C 0] for the independent rows of C, which a
/// rank-revealing QR finds.   Cost: cubic in V.   Ref: Vaitkus and Varady, section 5.3.2.
Solution solve(const Problem& problem);

}  // namespace planish::multipliers
