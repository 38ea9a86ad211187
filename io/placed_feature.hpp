// Features as they lie on a flat panel.
#pragma once

#include <string>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// A chain or a region of the flattened surface, and the figure that a chain was to become.
struct PlacedFeature {
  std::string name;
  std::vector<Index> vertex;    ///< the chain, in order; empty for a region
  bool closed = false;          ///< the last vertex is joined to the first, which is not repeated
  std::vector<Index> triangle;  ///< of a region; empty for a chain
  enum class Ideal { None, Line, Circle } ideal = Ideal::None;  ///< of a chain; arcs have a Circle
  double length = 0;                                            ///< of the chain, mesh units

  bool is_region() const { return vertex.empty(); }
};

}  // namespace planish
