// How bodies that share vertices hang together: joints between their poses, and who yields where templates differ a
// little (DESIGN 3.2, near agreement; 3.4, shared vertices).
#pragma once

#include "engine/constraints/compile.hpp"

namespace planish {

/// Equations between the poses of bodies (z = p + c t).
struct Joint {
  enum class Kind {
    Coincide,  ///< p_a + c_a t_a = p_b + c_b t_b, at one shared vertex
    Fit,       ///< p_a = p_b + c_b p0, c_a = c_b c0: template a lies nearest to template b
    Pin,       ///< p_a + c_a t_a = p0
    Fixed,     ///< p_a = p0, c_a = c0: a template nearest to its pins
  };
  Kind kind = Kind::Coincide;
  Index a = kNone, b = kNone;
  Index place_a = kNone, place_b = kNone;  ///< of the vertex in each body
  Vec2 p0 = {}, c0 = {1, 0};
  Index pin = kNone;  ///< number of the pin, or of one of them
};

struct Agreement {
  std::vector<std::vector<std::uint8_t>> yielded;  ///< per body and place: 1 where another one decides
  std::vector<double>
      mismatch;  ///< per body: largest distance at a vertex that it yielded, units of the mesh here
  std::vector<Index> mismatch_with;  ///< per body: the constraint that it yielded to, or kNone
  std::vector<Joint> joints;
};

/// Gives up a joint at a shared vertex: body a, of lower rank, yields the vertex, by `mismatch`.
/// Returns false, and does nothing, where the agreement has no such joint.
bool part(Agreement& agreement, const Compiled& compiled, const Joint& joint, double mismatch);

/// Fails: ConstraintsConflict: templates that differ on shared vertices by more than the set's agreement, or pins that
///        do; says which constraints, where and by how much.
/// Cost: O(shared vertices log).
Result<Agreement> agree(const Compiled& compiled, const ConstraintView& view, const OrderedMesh& mesh);

}  // namespace planish
