// The facade for checking: a mesh with its map in, what is true of it out.
#pragma once

#include "engine/model/constraint.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"
#include "engine/model/verification.hpp"

namespace planish {

struct VerifyOptions {
  int threads = 0;  ///< 0: the arena of the calling thread
};

/// What was said about a map, to be held against it.
struct Statements {
  const Claims* claims = nullptr;      ///< of its report; null: none
  const ConstraintSet* set = nullptr;  ///< its constraint file; needs claims, which have the features
};

/// Recomputes everything from the map alone: energies and stretch; flips by exact predicates, overwound vertices and
/// overlaps; of claims, every residual with the claimed chains and templates, and every claimed number; with a set also
/// that its constraints are answered, with the values that it prescribes. Nothing that makes maps is used.
///   corner_uv [3 T] in mesh units. Where corners of a vertex differ the surface counts as opened.
/// Ids are those of the surface given. What is wrong with the map or its claims is in the result, not an error.
/// Fails: BadUsage (a set without claims, corner_uv of another length); IndexOutOfRange, also of claimed ids; TooLarge;
///        NonFinitePosition, also of uv; the defects of diagnose() but ClosedComponent and HasHandles; OutOfMemory.
/// Cost: O(T log T).
/// Ref: DESIGN 3.8.
Result<Verification> verify(const Surface& surface, In<Vec2> corner_uv, const Statements& statements = {},
                            const VerifyOptions& options = {});

}  // namespace planish
