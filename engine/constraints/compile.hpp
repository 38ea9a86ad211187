// From constraints as a file states them to bodies, relations and pins.
#pragma once

#include "engine/constraints/body.hpp"
#include "engine/constraints/region_shape.hpp"
#include "engine/model/error.hpp"

namespace planish {

struct Compiled {
  std::vector<Body> bodies;  ///< those of constraints in the file's order (a seam: left, right), then chords
  std::vector<Relation> relations;
  std::vector<Pin> pins;
};

/// Templates are made, nothing is laid out yet.
/// Fails: ConstraintInvalid, ConstraintsConflict; names the constraint and its place in the file.
/// Cost: O(T) once where chains are closed, else O(what is named).
Result<Compiled> compile(const RestSurface& rest, const ConstraintView& view, const RegionMap& map);

}  // namespace planish
