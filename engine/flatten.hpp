// The facade: a mesh in, its flattening and a certificate out.
#pragma once

#include "engine/model/constraint.hpp"
#include "engine/model/error.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/mesh.hpp"
#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"

namespace planish {

/// Flattens every component as rigidly as possible (ARAP) and lays the components out side by side.
/// The surface's arrays are read, not kept. Concurrent calls are allowed.
/// Fails: BadUsage (an option out of range); IndexOutOfRange, TooLarge and the defects of diagnose();
/// OutOfMemory (also where estimates exceed options.memory_limit); Cancelled.
/// Cost: at 909k triangles 8 to 10 s on 2 cores; see perf/README.md.
/// Ref: Liu et al. 2008 (energy, local/global); Vaitkus and Varady (rotations first).
Result<Flattening> flatten(const Surface& surface, const FlattenOptions& options = {},
                           const Monitor& monitor = {});

/// Constraints and the features they speak of, as embed() put them into the edges of the surface.
struct Constraints {
  const ConstraintSet* set = nullptr;
  const std::vector<Feature>* features = nullptr;  ///< null: none, edges and pins alone
  In<Index> vertex_origin =
      {};  ///< of a surface that cut() opened: its vertices in the numbers of edges and pins
};

/// The same, with every constraint met to rounding in every iterate: shapes are eliminated from the unknowns, free scales
/// and orientations are found by the solver. Components with pins or directions are not turned, those with pins not moved.
/// Fails: as above; ConstraintInvalid and ConstraintsConflict, naming the constraints.
/// Cost: with 20 features on 1M triangles about that of none; see perf/README.md.
/// Ref: DESIGN 3.2 to 3.5; Vaitkus and Varady, section 5, whose multipliers are replaced by elimination.
Result<Flattening> flatten(const Surface& surface, const Constraints& constraints,
                           const FlattenOptions& options = {}, const Monitor& monitor = {});

/// What flattening with these constraints would work on, without solving it. Rotations are solved for, so contradictions are
/// found; open templates are taken the way round that the surface suggests, and are not turned onto pins.
struct ConstraintPlan {
  MeshFacts mesh;
  ConstraintFacts facts;    ///< outcome is empty
  Offset unknowns = 0;      ///< complex ones of the sparse part
  Offset memory_bytes = 0;  ///< estimate of the solve's peak
  Offset newton_bytes = 0;  ///< the same where flips or overlaps have to be removed; 0: nothing removes them
};
Result<ConstraintPlan> plan(const Surface& surface, const Constraints& constraints,
                            const FlattenOptions& options = {}, const Monitor& monitor = {});

}  // namespace planish
