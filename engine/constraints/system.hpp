// All that a constraint set means for one surface: bodies, joints, orientations, DOF maps, and what came of them.
#pragma once

#include <functional>

#include "engine/constraints/dof_map.hpp"
#include "engine/constraints/orientation.hpp"
#include "engine/model/flattening.hpp"

namespace planish {

class ConstraintSystem {
 public:
  /// Compiles the set, settles who yields to whom, and numbers the unknowns.
  /// vertex_component [V].  All arguments but map must outlive the system.
  /// Fails: ConstraintInvalid, ConstraintsConflict; OutOfMemory.
  static Result<std::unique_ptr<ConstraintSystem>> make(const RestSurface& rest, const ConstraintView& view,
                                                        const RegionMap& map, In<Index> vertex_component);

  const NodeMap& nodes() const { return nodes_; }

  /// First rotations and directions. Fails: as orient().
  Result<void> orient(const Exec& exec, const StartInput& input, Init init);
  In<double> theta() const { return orientation_.theta; }
  double holonomy_residual() const { return orientation_.residual; }
  /// Turns the first rotations and directions of components; those whose direction is given stay, or take half a turn
  /// where that is nearer and their direction is that of undirected lines.
  void turn(In<double> by_component);
  /// Components whose direction is given.
  In<std::uint8_t> directed() const { return orientation_.directed; }
  /// The same without pins, oriented alike: where the map would lie by itself.
  Result<std::unique_ptr<ConstraintSystem>> without_pins() const;
  const std::vector<Pin>& pins() const { return compiled_.pins; }
  /// To another place. Returns whether features and directions are to be found anew: not for a pin that has only free
  /// vertices around it, where no joints were parted. What fails leaves the pin where it was.
  ///   vertex: as pins name it;  uv: units of the ordered mesh
  /// Fails: BadUsage (no such pin); ConstraintsConflict (pins that their shape cannot take).
  Result<bool> move_pin(Index vertex, Vec2 uv);

  /// In place of orient(): directions, and the sides of templates that the surface leaves open, as they suit a given map
  /// best. Returns by how much each component of the map is to be turned so that directions against the u axis and between
  /// components are met, radians.
  ///   uv [V] units of the ordered mesh
  /// Fails: ConstraintsConflict (angles that do not add up).
  Result<std::vector<double>> orient_at(In<Vec2> uv);
  /// Poses that meet all joints, near to where the templates fit a map best.   Pre: orient_at().
  /// Fails: ConstraintsConflict where joints do not close, or shapes fold triangles.
  Result<std::unique_ptr<Poses>> poses_at(In<Vec2> uv) const;

  /// DOF maps from the start; frozen: directions stay as the first rotations have them.
  /// Fails: ConstraintsConflict where joints do not close.
  Result<std::unique_ptr<DofMap>> dof_map(bool frozen) const;
  /// The same from given poses, closed.
  std::unique_ptr<DofMap> dof_map(std::unique_ptr<Poses> poses, bool frozen) const;

  /// [T] 1 for triangles that have an edge of a feature or belong to a region: the paper's local phase leaves them.
  std::vector<std::uint8_t> triangles_at_features() const;

  /// Of each constraint, residuals measured on coordinates.
  ///   uv [V] of the ordered mesh, mesh units, placed as they will be written
  std::vector<ConstraintOutcome> outcomes(In<Vec2> uv) const;
  /// Fails: ConstraintsConflict where a free scale fell below 1e-3.
  Result<void> check_scales(const Poses& poses) const;

  const Compiled& compiled() const { return compiled_; }
  const Assemblies& assemblies() const { return assemblies_; }
  const Orientation& orientation() const { return orientation_; }
  const Agreement& agreement() const { return agreement_; }
  /// Which body decides the place of each feature vertex.
  const std::vector<Owner>& owners() const { return owners_; }
  /// Lays an open template the other way round; directions are to be found anew.
  Result<void> mirror(Index body);

 private:
  ConstraintSystem(const RestSurface& rest, const ConstraintView& view, In<Index> vertex_component)
      : rest_(rest), view_(view), vertex_component_(vertex_component) {}
  Result<void> settle();
  bool is_beside(Index vertex) const;
  void find_nodes();  ///< where pins are
  /// Tries a step; where constraints contradict one another, again with a template turned round whose way the surface
  /// leaves open. The first contradiction where no single turn helps.
  Result<void> any_way_round(const std::function<Result<void>()>& step);
  Result<void> orient_once(const Exec& exec, const StartInput& input, Init init);
  void part_joints();
  bool half_turn_is_free(Index component) const;
  void choose_sides_at(In<Vec2> uv);
  Result<std::vector<PartedJoint>> nearly_closed_at(In<BodyFit> fit) const;
  ConstraintOutcome outcome_of_body(const Body& body, Index number, In<Vec2> uv) const;
  ConstraintOutcome outcome_of_relation(std::size_t number, In<Vec2> uv) const;
  ConstraintOutcome outcome_of_pins(Index constraint, In<Vec2> uv) const;
  ConstraintOutcome begin_outcome(Index constraint) const;
  Vec2 measured_vector(Index body, In<Vec2> uv) const;

  RestSurface rest_;
  ConstraintView view_;
  In<Index> vertex_component_;
  Compiled compiled_;
  Agreement agreement_;
  Assemblies assemblies_;
  std::vector<Owner> owners_;
  NodeMap nodes_;
  Orientation orientation_;
};

}  // namespace planish
