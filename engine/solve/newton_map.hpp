// A map that projected Newton steps move: the whole surface with its features, or a neighbourhood with its rim held.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/solve/boundary_barrier.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/solve/reduced_hessian.hpp"

namespace planish {

class NewtonMap {
 public:
  /// x: [V], or [dof.size()] with a DOF map, expanded there.   dof: null where vertices alone move.
  /// All arguments but the unknowns must outlive it.
  NewtonMap(const Exec& exec, const ArapEnergy& mesh, ReducedUnknowns unknowns, DofMap* dof,
            std::vector<Vec2> x);
  NewtonMap(NewtonMap&&) noexcept;
  ~NewtonMap();

  /// The energy that steps lower from now on; evaluated at the present place.
  void lower(const MapDensity& density);
  double energy() const { return energy_; }  ///< not divided by the area
  In<Vec2> uv() const { return In<Vec2>(x_).first(mesh_.num_vertices()); }
  const std::vector<Vec2>& x() const { return x_; }
  MapEnergy& measure() { return measure_; }
  /// No flipped triangle, and no edge that runs backwards along a line.
  bool is_positive() const {
    return measure_.flipped(uv()).empty() && (!dof_ || dof_->reversed_edges() == 0);
  }
  /// Another place to go on from; x as in the constructor.
  void move_to(std::vector<Vec2> x);

  /// Prepares a Newton direction with the Hessian that share of the way towards its projection; 1 is positive semidefinite,
  /// below that a smaller share is tried next time where it was definite, and a larger one at once where it was not.
  /// Fails: OutOfMemory, FactorizationFailed (projected too: the map is degenerate).
  Result<void> prepare();
  /// Prepares a quasi-Newton direction with the factor that prepare() made, bent by what the steps since then have taught: at
  /// the cost of a solve.   Pre: the last advance() has moved.
  void prepare_again();
  /// sqrt(g^T H^-1 g / E) with the matrix factored last (DESIGN 3.5), where the direction was prepared last.
  double gradient() const { return gradient_; }

  /// Moves along the direction prepared last. With an energy that is infinite at flips: by less than the first flip of any
  /// triangle on the linearised path, and never to a place with a flipped triangle or an overwound vertex. False, and
  /// where it was, where no length lowers the energy.
  bool advance();
  /// Of the last advance(): the share of the direction gone, and of what a quadratic energy would have fallen by.
  struct Stride {
    double length = 0, gain = 0;
  };
  const Stride& stride() const { return stride_; }
  /// From now on the boundary does not cross itself: its barrier is part of the energy. barrier: outlives the map, or null.
  void keep_apart(const BoundaryBarrier* barrier) { barrier_ = barrier; }
  /// Elimination orders found for what contacts couple; where they couple few vertices that of the unknowns serves.
  int orders_found() const { return orders_found_; }
  /// From the next lower() on stiffness times the squared distances of vertices from places is part of the energy. Free
  /// vertices alone; the places outlive the map.
  void pull(In<std::pair<Index, Vec2>> places, double stiffness) {
    places_ = places;
    stiffness_ = stiffness;
  }

 private:
  bool keeps_positive() const { return density_.kind != MapDensity::Kind::Untangling; }
  Out<Vec2> vertices(std::vector<Vec2>& x) const { return Out<Vec2>(x).first(mesh_.num_vertices()); }
  double evaluate_at(std::vector<Vec2>& x, std::vector<Vec2>& force);
  double evaluate_vertices(std::vector<Vec2>& x, std::vector<Vec2>& force);
  double fold(double energy_of_vertices, std::vector<Vec2>& force);
  double add_line_edges(std::vector<Vec2>& force) const;
  double first_reversal() const;
  Result<void> factor(double lift);
  bool couples_many() const;
  void bound_length();
  std::vector<HessianElement> contacts(bool& pattern_is_new);
  double add_pull(In<Vec2> uv, Out<Vec2> force) const;
  void solve();
  void renew_moves();
  struct Learnt;

  const Exec& exec_;
  ArapEnergy mesh_;
  ReducedUnknowns unknowns_;
  DofMap* dof_;
  MapEnergy measure_;
  MapDensity density_;
  ReducedHessian hessian_;
  std::optional<GlobalPhase> global_;
  std::vector<Index> order_;  // the unknowns' own
  std::vector<Vec2> x_, force_, direction_, x_trial_, force_trial_;
  double energy_ = 0, force_times_direction_ = 0, length_ = 1, gradient_ = 0;
  Stride stride_;
  std::unique_ptr<Learnt> learnt_;  // since the factor was made; null: nothing yet
  double projection_ = 1;
  int orders_found_ = 0;
  std::vector<double> multiple_;  // [T] of det J, for ARAP
  const BoundaryBarrier* barrier_ = nullptr;
  In<std::pair<Index, Vec2>> places_;
  double stiffness_ = 0;
  std::vector<std::array<Index, 3>> coupled_;  // by the barrier, in the matrix that was analysed
};

/// Unknowns of a whole map. order: fill-reducing, of the vertices.
///   turns_freely: per component, 1 where nothing says how it is turned: a coordinate of a vertex far from its centre is held
ReducedUnknowns whole_unknowns(const DofMap& dof, In<Index> order, In<Index> vertex_component,
                               In<std::uint8_t> turns_freely, In<Vec2> x);

}  // namespace planish
