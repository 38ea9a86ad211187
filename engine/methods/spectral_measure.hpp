// Energy and boundary mass of maps, and products of vectors by them, component by component.
#pragma once

#include <array>
#include <vector>

#include "engine/methods/conformal_energy.hpp"
#include "engine/workpiece.hpp"

namespace planish {

/// A vector of the iteration, and E and B times it.
struct Image {
  std::vector<Vec2> change;  ///< unknowns
  std::vector<Vec2> moved;   ///< [V] displacement, or the place itself
  std::vector<Vec2> e, b;    ///< [V]
};

class SpectralMeasure {
 public:
  /// Must outlive it: exec, piece.
  SpectralMeasure(const Exec& exec, const Workpiece& piece);

  const ConformalEnergy& energy() const { return energy_; }
  In<double> mass() const { return mass_; }  ///< [V] of the boundary
  double mass_of(Index component) const { return component_mass_[component]; }
  Index num_components() const { return static_cast<Index>(component_mass_.size()); }
  Index component_of(std::size_t v) const { return piece_.component[v]; }

  /// E and B times what moved; B's about the component's mean.
  void fill_products(Image& image) const;
  /// Per component, of complex vectors [V]: conj(a) b.
  std::vector<Vec2> products(In<Vec2> a, In<Vec2> b) const;
  /// E / B of each component.
  std::vector<double> quotients(const Image& here) const;
  /// What of a step is no scaling and no rotation of a component's map, over the map, in the metric E + B / mass; the largest
  /// of these components.
  double relative_size(const Image& step, const Image& here, In<Index> components) const;
  /// Shares of the step and of the step before (empty: none) that make E / B least, per component.
  std::vector<Vec2> best_shares(const Image& here, const Image& step, const Image& before,
                                In<Index> components) const;

 private:
  const Workpiece& piece_;
  std::vector<double> mass_, component_mass_;
  ConformalEnergy energy_;
};

/// b [V]: half the length of the boundary edges at each vertex, units of the ordered mesh.
std::vector<double> boundary_mass(const Workpiece& piece);

}  // namespace planish
