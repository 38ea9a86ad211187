// Which body decides the place of each feature vertex.
#pragma once

#include "engine/constraints/agreement.hpp"
#include "engine/constraints/poses.hpp"

namespace planish {

struct Owner {
  Index vertex, body, place;
};

/// By vertex: of the bodies that do not yield it the one of highest rank; vertices that all bodies yield to pins are left
/// out.
std::vector<Owner> find_owners(const Compiled& compiled, const Agreement& agreement);

/// The compiled constraints that are kept, and what bodies they had as numbers (kNone: dropped). Chords stay with the
/// relations that measure them.
struct Restricted {
  Compiled compiled;
  std::vector<Index> body;  ///< per body of the whole: its new number
};
Restricted restrict_to(const Compiled& compiled, const std::vector<std::uint8_t>& keep_constraint);

/// A smallest part of the constraints for which `fails` still holds, found by leaving out one after the other.
template <class Fails>
std::vector<Index> smallest_failing(std::vector<Index> constraints, std::size_t num_constraints,
                                    Fails fails) {
  constexpr std::size_t kMost = 64;  // more are named as they are
  std::sort(constraints.begin(), constraints.end());
  constraints.erase(std::unique(constraints.begin(), constraints.end()), constraints.end());
  if (constraints.size() > kMost) return constraints;
  for (std::size_t k = constraints.size(); k-- > 0;) {
    std::vector<std::uint8_t> keep(num_constraints, 0);
    for (std::size_t i = 0; i < constraints.size(); ++i) keep[constraints[i]] = i != k;
    if (fails(keep)) constraints.erase(constraints.begin() + static_cast<std::ptrdiff_t>(k));
  }
  return constraints;
}

}  // namespace planish
