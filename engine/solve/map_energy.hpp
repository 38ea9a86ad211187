// The energies of maps without flips, summed over a mesh: values, forces, and how far a step may go.
#pragma once

#include <optional>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/solve/local_phase.hpp"
#include "engine/solve/winding.hpp"
#include "kernels/local/isotropic.hpp"

namespace planish {

/// An energy density of kernels/local/isotropic, chosen at run time.
struct MapDensity {
  enum class Kind { Arap, SymmetricDirichlet, Untangling };
  Kind kind = Kind::Arap;
  Barrier barrier = {};  ///< of Arap
  double epsilon = 0;    ///< of Untangling, > 0

  IsotropicTerms operator()(const Wirtinger& j) const {
    if (kind == Kind::Arap) return barred_arap_terms(j, barrier);
    return kind == Kind::SymmetricDirichlet ? symmetric_dirichlet_terms(j) : untangling_terms(j, epsilon);
  }
};

/// Images of a triangle's corners.
inline std::array<Vec2, 3> corner_images(In<Index> corner_vertex, Index t, In<Vec2> uv) {
  return {uv[corner_vertex[3 * t]], uv[corner_vertex[3 * t + 1]], uv[corner_vertex[3 * t + 2]]};
}

/// Energy of a triangle at the corners z, and half its gradient with respect to them.
ProxyForces triangle_forces(const MapDensity& density, const RestFrame& frame, const std::array<Vec2, 3>& z);

/// Half the Hessian of a triangle's energy, moved by a share of the way towards its projection: 0 as it is, 1 positive
/// semidefinite. Projected is what it is together with a multiple of det J.
std::array<std::array<Mat2, 3>, 3> triangle_hessian(const MapDensity& density, double projection,
                                                    double multiple, const RestFrame& frame,
                                                    const std::array<Vec2, 3>& z);

/// Energy of an edge that must not run backwards, and its derivatives, as a function of its length over its rest length:
/// the barrier, or (x^2 + 1) / chi(x) while untangling.   Ref: DESIGN 3.4.
struct EdgeTerms {
  double value = 0, first = 0, second = 0;
};
EdgeTerms edge_terms(const MapDensity& density, double x);

/// Part of the way to the first flip that a step may go.
inline constexpr double kShareOfFirstFlip = 0.9;

class MapEnergy {
 public:
  MapEnergy(const Exec& exec, const ArapEnergy& mesh);

  /// Energy (not divided by the area) at uv [V]; force [V] out: half its gradient, 0 at fixed vertices. Infinite, and the
  /// forces without meaning, where the density is. Cost: O(T), parallel.
  double evaluate(const MapDensity& density, In<Vec2> uv, Out<Vec2> force);
  /// The least t > 0 at which a triangle of uv + t direction has no area. Pre: none is flipped at uv.
  double first_flip(In<Vec2> uv, In<Vec2> direction) const;
  /// Triangles that are not positively oriented, by the exact predicate, ascending.
  std::vector<Index> flipped(In<Vec2> uv) const;
  /// Neither flipped triangles nor overwound vertices. One call at a time.
  bool is_injective(In<Vec2> uv) const;
  /// The least det J, by rounding arithmetic.
  double least_determinant(In<Vec2> uv) const;

 private:
  template <class Value>
  double least(Value value) const;

  const Exec& exec_;
  ArapEnergy mesh_;
  std::vector<Vec2> corner_force_;
  mutable std::optional<Winding> winding_;  // once it is asked for
};

}  // namespace planish
