// What a map editor keeps between its calls.
#pragma once

#include <chrono>
#include <optional>

#include "engine/deform/given_map.hpp"
#include "engine/deform/placed_features.hpp"
#include "engine/deform/responses.hpp"
#include "engine/edit.hpp"
#include "engine/solve/overlap_free.hpp"

namespace planish {

/// What is wrong with a map, the worse first: flipped triangles and overwound vertices; overlapping pairs where none are
/// wanted.
struct Faults {
  Offset turned = 0, overlapping = 0;
  auto operator<=>(const Faults&) const = default;
};

/// What is done about flips, and when they are looked for.
enum class Mending {
  None,     ///< nothing
  AtEnd,    ///< where few are expected, or the start is one to get away from
  Watched,  ///< at every step, which costs a third of it
};

class Editing {
 public:
  explicit Editing(const EditOptions& options)
      : options_(options), exec_(options.threads), responses_(exec_) {}

  Result<void> begin(const Surface& surface, In<Vec2> uv, const Monitor& monitor);
  Result<void> constrain(const Constraints& constraints, const Monitor& monitor);
  Result<void> move_pin(Index vertex, Vec2 uv);
  Result<void> solve(const SolveOptions& options, const Monitor& monitor, const StepSink& sink);
  /// The map as it is now, as a step.
  DeformStep snapshot(int step) const;
  Result<void> say_step(int step, const StepSink& sink);
  /// From [V] of the ordered mesh, its units, to the input's vertices, mesh units.
  std::vector<Vec2> in_input_order(In<Vec2> uv) const;
  In<Vec2> uv() const { return uv_; }
  In<Vec2> aligned() const { return aligned_; }
  Deformation measure();

 private:
  /// Announces a step and times it; several of one name add up.
  template <class Step>
  Result<void> timed(Phase phase, const Monitor& monitor, Step step) {
    if (monitor && monitor({.phase = phase}) == Verdict::Stop)
      return fail(ErrorCode::Cancelled, "stopped by the caller");
    const auto begin = std::chrono::steady_clock::now();
    Result<void> done = step();
    add_time(phase, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    return done;
  }
  void add_time(Phase phase, double seconds);

  Result<void> compile(const Constraints& constraints, const Monitor& monitor);
  Result<void> place();
  bool keeps_placed() const;
  void align(std::vector<Placement> motion);
  void find_held();
  Result<void> factor();
  SymmetricMatrix laplacian_over(const NodeMap& nodes) const;

  Result<void> go_on(const SolveOptions& options, const Monitor& monitor, const StepSink& sink);
  Result<Minimum> follow(const SolveOptions& options, const Monitor& monitor, const StepSink& sink);
  Result<Minimum> follow_held(const SolveOptions& options, const Monitor& monitor);
  Result<void> relax_near(In<Vec2> way);
  Result<Minimum> last_step(const SolveOptions& options, const Monitor& monitor);
  Result<Minimum> step_on_the_way(const SolveOptions& options, const Monitor& monitor, bool mending);
  Result<Minimum> minimise(const FlattenOptions& options, const Monitor& monitor, Mending mending,
                           bool begins_near = false);
  Result<Minimum> lower(const ArapProblem& arap, const FlattenOptions& options, const Monitor& monitor,
                        Mending mending, const OverlapFreeStarts& starts);
  /// How the map is looked at by steps that are told everything.
  Mending mending() const { return last_.flips == Flips::Untangle ? Mending::Watched : Mending::None; }
  bool has_features() const { return system_ && !system_->compiled().bodies.empty(); }
  FlattenOptions flatten_options(const SolveOptions& options) const;

  Result<Minimum> let_go(Minimum best, const SolveOptions& options, const Monitor& monitor);
  Result<Minimum> release(const SolveOptions& options, const Monitor& monitor, Mending mending);
  Result<Minimum> start_anew(const SolveOptions& options, const Monitor& monitor);
  Result<std::unique_ptr<ConstraintSystem>> compiled_system(const Monitor& monitor) const;
  Faults faults(In<Vec2> uv) const;
  bool is_as_asked(const Minimum& minimum) const;
  bool is_injective(const ArapProblem& arap, In<Vec2> uv) const;

  OverlapFreeStarts held_starts(const ArapProblem& arap, const FlattenOptions& options,
                                const Monitor& monitor);
  OverlapFreeStarts released_starts(const ArapProblem& arap, const FlattenOptions& options,
                                    const Monitor& monitor);
  OverlapFreeStarts anew_starts(const ArapProblem& arap, const FlattenOptions& options,
                                const Monitor& monitor);
  Result<OverlapFreeStarts::Map> before_steps(ArapProblem arap, DofMap* first, std::unique_ptr<DofMap> dof,
                                              FlattenOptions options, const Monitor& monitor) const;
  Result<OverlapFreeStarts::NearConstraints> near_places(ConstraintSystem& system, std::vector<Vec2> uv);
  const Poses& final_poses(const Minimum& minimum, const DofMap& dof) const;

  void move_back(const ConstraintSystem& system, Out<Vec2> uv) const;
  void keep(Minimum minimum);
  void settle_gauge();
  ArapProblem problem(GlobalPhase& global, const NodeMap& nodes, DofMap& dof, In<Vec2> rotation) const;
  std::vector<Vec2> closest_rotations() const;
  std::vector<std::uint8_t> components_that_turn() const;
  std::vector<std::uint8_t> components_that_turn_released() const;
  std::vector<Vec2> in_mesh_units(In<Vec2> uv) const;
  DeformFacts facts(In<Vec2> map) const;

  const Geometry& rest() const { return reference_ ? *reference_ : piece_.geometry; }
  const OrderedMesh& mesh() const { return piece_.mesh(); }
  const Topology& topology() const { return piece_.topology(); }

  EditOptions options_;
  Exec exec_;
  Workpiece piece_;
  GivenMap given_;
  std::optional<Geometry> reference_;  // of the map, where that is the reference

  ConstraintSet set_;
  std::vector<Feature> features_;  // in the numbers of the ordered mesh
  std::vector<Index> vertex_origin_;
  ConstraintView view_;
  std::unique_ptr<ConstraintSystem> system_;  // none without constraints

  std::vector<Vec2> aligned_;      // [V] the given map, components moved as pins and directions ask
  std::vector<Placement> laid_;    // what of it pins alone ask for; none where nothing is placed
  std::vector<Placement> motion_;  // by which they were, per component
  std::optional<PlacedFeatures> placed_;
  NodeMap nodes_;                           // all feature vertices and pins held
  std::vector<Index> alone_;                // held in components that have neither
  std::vector<std::uint8_t> factored_for_;  // [V] what was held when the factor was made
  std::optional<GlobalPhase> global_;
  std::optional<LocalPhase> local_;  // for the same
  std::optional<MapEnergy> measure_;
  VectorPool pool_;  // what solves return their memory to

  std::vector<Vec2> uv_;  // [V] where the map is
  bool settled_ = false;  // at a minimum without flips, features held
  Responses responses_;   // of the map to what is held
  SolveOptions last_;     // of the last solve, and what came of it
  Flattening solved_;
  Release release_ = Release::None;
  std::vector<StepFacts> way_;
  std::unique_ptr<ConstraintSystem> anew_;         // of a map that was flattened anew
  std::unique_ptr<ConstraintSystem> near_system_;  // oriented at the map of the surface without constraints
  std::unique_ptr<DofMap> separated_dof_;  // of features pulled into place, where overlaps were removed so
};

}  // namespace planish
