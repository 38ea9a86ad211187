// Rotations first, with prescribed edges: sectors for stars, constraint rows along dual paths (DESIGN 3.1, 3.3).
#pragma once

#include <optional>

#include "engine/constraints/sectors.hpp"
#include "engine/solve/border.hpp"
#include "engine/solve/laplacian.hpp"
#include "engine/solve/start.hpp"

namespace planish {

/// Triangle angles, and how they were integrated.
struct Rotations {
  std::vector<double> theta;      ///< [T] radians
  std::vector<double> potential;  ///< per node
  double residual = 0;            ///< largest one of any row, radians
};

/// A row along dual paths: the sum of sign times the angles of triangles shall change by `change`, radians.
struct PathRow {
  struct End {
    Index triangle = kNone;
    double sign = 1;
  };
  std::vector<End> end;
  double change = 0;
};

class RotationProblem {
 public:
  /// Analyses and factors; which edges are fixed is taken from the layout, its points are not. exec and input must outlive
  /// the problem.
  /// Fails: FactorizationFailed, OutOfMemory.
  static Result<RotationProblem> make(const Exec& exec, const RestSurface& rest, const StartInput& input,
                                      const Layout& layout, Init init);

  /// The smallest connection whose sectors have the layout's angles.
  /// Fails: ConstraintsConflict: a part whose sectors do not sum as Gauss-Bonnet has it, or angles around a vertex that do
  ///        not sum to 2 pi; `at` receives vertices of the features at fault. ResidualTooLarge.
  Result<Rotations> solve(const Layout& layout, std::vector<Index>& at) const;

  /// The smallest connection that meets further rows along paths from each component's first triangle.
  /// Fails: FactorizationFailed where rows depend on one another; ResidualTooLarge.   Cost: a sparse solve a row.
  Result<Rotations> adjust(const Layout& layout, const Rotations& base,
                           const std::vector<PathRow>& rows) const;

 private:
  struct Part {               // of the nodes, joined by free dual edges and not to the ground
    std::vector<Index> node;  // ascending; the row of the first is implied by the others
    std::vector<Index> sector;
  };

  RotationProblem(const Exec& exec, const RestSurface& rest, const StartInput& input)
      : exec_(&exec), rest_(rest), input_(input) {}
  void number_nodes();
  void find_parts();
  void walk_tree();
  /// Per sector: by how much the closest rotations of its outermost triangles turn it beyond its edges.
  std::vector<double> bends(const Layout& layout) const;
  Result<std::vector<double>> targets(const Layout& layout, std::vector<Index>& at) const;
  Result<void> check_parts(In<double> target, std::vector<Index>& at) const;
  std::vector<double> integrate(const Layout& layout, In<double> potential, In<double> extra) const;
  double step(In<double> potential, Index c) const;  ///< w of half-edge c

  const Exec* exec_;
  RestSurface rest_;
  StartInput input_;
  EdgeWeight weight_ = [](Index) { return 1.0; };
  Sectors sectors_;
  std::vector<double> sector_angle_;  // sums of corner angles
  std::vector<Index> node_;           // per sector
  Index num_nodes_ = 0;
  std::vector<Part> part_;
  std::vector<Index> hole_of_node_;  // per hole node: its loop
  std::vector<Index> parent_;  // [T] half-edge of the parent that is crossed, kNone at a component's first
  std::vector<Index> tree_order_;
  SymmetricMatrix laplacian_;
  std::optional<GlobalPhase> global_;
};

}  // namespace planish
