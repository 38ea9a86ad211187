// A feature's chain as the file shows it: in space and, on one of its sides, in the map.
#pragma once

#include <string>
#include <vector>
#include <tl/expected.hpp>

#include "engine/model/feature.hpp"
#include "engine/verify/written_map.hpp"

namespace planish {

struct MeasuredChain {
  /// An edge of the chain between two of its places.
  struct Step {
    std::size_t from = 0, to = 0;
    double length = 0, image_length = 0;
    bool kept = true;  ///< neither end yielded
  };

  std::vector<Index> vertex;
  bool closed = false;
  std::vector<Vec3> space = {};
  std::vector<Vec2> image = {};
  std::vector<Step> step = {};         ///< in order, the closing one last
  std::vector<std::size_t> kept = {};  ///< places of the vertices that did not yield
  double length = 0;                   ///< in space, with the closing edge
  double kept_length = 0;              ///< of the steps that are kept

  std::vector<double> lengths() const;
  /// Of the vertices that did not yield, or of all where they are fewer than asked for.
  std::vector<Vec2> image_of_kept(std::size_t fewest) const;
  /// Length in the map over length in space, of the steps that are kept; 0 where none are.
  double factor() const;
  /// The part of the chain that the factor is measured on.
  double reach() const { return kept_length / length; }
  /// Largest difference of a kept edge's length in the map from `factor` times that in space, over the length.
  double edge_error(double factor) const;
};

/// side: 0, or of a seam 1 left and 2 right of the chain.   yielded: vertices, ascending.
/// Fails: what is wrong with the chain on this mesh, as a clause.
tl::expected<MeasuredChain, std::string> measure_chain(const WrittenMap& map, const Feature& feature,
                                                       int side, In<Index> yielded);

/// Twice the area that a closed polygon has counter-clockwise.
double twice_area(In<Vec2> polygon);

/// Mean of the unit normals of the triangles beside a chain; zero where they cancel.
Vec3 surface_normal(const WrittenMap& map, const MeasuredChain& chain);

}  // namespace planish
