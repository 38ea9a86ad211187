// Methods other than ARAP that make a map of the same surface under the same constraints: what they take, and the table
// of them.
#pragma once

#include "engine/constraints/system.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"
#include "engine/workpiece.hpp"

namespace planish {

/// What a map is made of. Without constraints view, system, dof and first are empty.
struct MapInput {
  const Exec& exec;
  const Workpiece& piece;                    ///< ordered, measured, its elimination order found
  const ConstraintView* view = nullptr;      ///< as the method has loosened it
  const ConstraintSystem* system = nullptr;  ///< oriented
  DofMap* dof = nullptr;                     ///< of the system; in and out: its poses become those of the map
  In<Vec2> first =
      {};  ///< [V] the map that the first rotations ask for, in units of the ordered mesh; dof's poses are of it
};

struct MethodMap {
  std::vector<Vec2> uv;  ///< [V] units of the ordered mesh
  int iterations = 0;    ///< solves beyond the first
  std::optional<IntrinsicFacts> intrinsic = {};
};

/// A method and what it can express.
struct MapMethod {
  Method method;
  /// Why it cannot express a constraint; null: it can.
  const char* (*refusal)(const Constraint& constraint);
  /// Lets go what it keeps up to a factor only; whether there was any.
  bool (*loosen)(Constraint& constraint);
  /// Its map is determined up to a similarity of each component that no two pins hold, so that a size is chosen for it.
  bool any_size;
  Result<MethodMap> (*map)(const MapInput& input, const Monitor& monitor);
};

/// Null for Arap and Deform, which have their own ways.
const MapMethod* find_map_method(Method method);

/// The constraints as a method can express them.
struct Loosened {
  ConstraintSet set;
  std::vector<std::string> up_to_scale;  ///< names of those whose given size was let go
};

/// Fails: ConstraintUnsupported, naming every constraint that the method cannot express, and why.
Result<Loosened> loosen(const MapMethod& method, const ConstraintSet& set);

}  // namespace planish
