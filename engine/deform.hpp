// The facade for deforming: a map that exists already, brought to its constraints.
#pragma once

#include "engine/edit.hpp"

namespace planish {

struct DeformOptions {
  EditOptions edit;
  SolveOptions solve;
};

/// Brings a given map to its constraints, changing it as little as possible: constrained elements are placed where they
/// lie nearest to the map and held there, the rest follows as rigidly as possible. Where flips remain that way, features
/// are released to the places that the solver finds for them. Components without constraints stay where they lie.
///   uv [V] one a vertex
/// Fails: as MapEditor.   Cost: about that of flatten().
/// Ref: Vaitkus and Varady, section 6; DESIGN 3.7.
Result<Deformation> deform(const Surface& surface, In<Vec2> uv, const Constraints& constraints,
                           const DeformOptions& options = {}, const Monitor& monitor = {},
                           const StepSink& sink = {});

}  // namespace planish
