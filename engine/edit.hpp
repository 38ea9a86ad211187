// The facade for editing: a map that follows its constraints, analysed and factored once.
#pragma once

#include <functional>
#include <memory>

#include "engine/flatten.hpp"
#include "engine/model/deformation.hpp"

namespace planish {

/// Called with the map as a solve begins, as step 0, and after each of its steps.
using StepSink = std::function<Result<void>(DeformStep)>;

/// A given map of a surface, whose constrained elements are brought to their shapes and held there, while the rest follows
/// as rigidly as possible. Constraints, pins and steps may change; what is solved next starts from where the map is, and
/// only what changed is done anew: the elimination order once, the factorization where other vertices are held, compiling
/// and placing where constraints changed. Where constrained elements lie depends on the given map alone, not on the way.
/// One call at a time; other objects may be in use meanwhile.   Ref: Vaitkus and Varady, section 6; DESIGN 3.7.
class MapEditor {
 public:
  /// The surface and the map are read, not kept.   uv [V] one a vertex: open the surface where the map is torn (cut_where_torn)
  /// Fails: BadUsage (sizes, options); the defects of diagnose(); NonFinitePosition (uv), NoParameterization (a component
  /// without area), DegenerateTriangle (a map as reference with triangles of no area); OutOfMemory, Cancelled.
  /// Cost: order of elimination, 3 microseconds a vertex.
  static Result<MapEditor> begin(const Surface& surface, In<Vec2> uv, const EditOptions& options = {},
                                 const Monitor& monitor = {});

  /// Takes other constraints; set and features are copied.   Fails: ConstraintInvalid, ConstraintsConflict, OutOfMemory,
  /// FactorizationFailed, Cancelled; the editor then has the constraints that failed, and must be given others.
  /// Cost: a factorization where other vertices are held than before.
  Result<void> constrain(const Constraints& constraints, const Monitor& monitor = {});

  /// Moves a pin that the constraints have.   vertex: number in the pins;  uv: mesh units
  /// Fails: BadUsage (no such pin, no place); ConstraintsConflict.   Cost: O(V), no factorization.
  Result<void> move_pin(Index vertex, Vec2 uv);

  /// From where the map is to the minimum.
  /// Fails: BadUsage; ConstraintsConflict (a free scale below 1e-3); Cancelled, OutOfMemory, FactorizationFailed; and what
  /// the sink fails with. After Cancelled the map is the one before.
  /// Cost: a solve and a local phase an iteration; after moves of pins half as many as at first, once two moves taught how the
  /// map follows, and a third once five did, for which 16 bytes a vertex of each of the last six are kept, as the memory
  /// of a solve is for the next, some 300 bytes a vertex; where flips appear, that of remove_flips() and polish().
  Result<void> solve(const SolveOptions& options = {}, const Monitor& monitor = {},
                     const StepSink& sink = {});

  std::vector<Vec2> uv() const;  ///< [V] mesh units; 0 0 for unreferenced vertices
  /// The map as it was given, in mesh units, its components moved onto pins and directions.
  std::vector<Vec2> given_uv() const;
  /// Everything about the map as it is now (DESIGN 3.8), and about the last solve.   Cost: O(T log T).
  Deformation measure() const;

  MapEditor(MapEditor&&) noexcept;
  MapEditor& operator=(MapEditor&&) noexcept;
  ~MapEditor();

 private:
  class State;
  explicit MapEditor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace planish
