// Energies of a map with and without its constraints.
#pragma once

#include <string>
#include <vector>

namespace planish {

struct ConstraintPrice {
  std::string name;
  double energy_without = 0;  ///< `arap` with all constraints but this one
  double cost = 0;            ///< energy of the whole set minus that
  std::string reason = {};    ///< why there is no such energy: the set without it cannot be solved
};

struct Price {
  double energy = 0;         ///< `arap` with all constraints
  double unconstrained = 0;  ///< without any, on the same mesh
  double without_refit = 0;  ///< with all, directions kept as the first rotations have them
  std::vector<ConstraintPrice> constraints = {};  ///< in the order of the file
};

}  // namespace planish
