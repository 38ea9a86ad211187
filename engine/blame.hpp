// Where flips remain: which features are there, and which constraint makes the difference.
#pragma once

#include "engine/flatten.hpp"

namespace planish {

struct Blame {
  std::vector<std::string> features;     ///< those with a vertex of a flipped triangle, or an overwound one
  std::vector<std::string> constraints;  ///< without any one of which there are no flips
  Index tried = 0;  ///< constraints left out, in the order of the file, until time was up
};

/// Leaves out one constraint after the other and flattens again, for as long as the time allows.
///   flattening: of these constraints, with flips
/// Fails: Cancelled.   Cost: a flattening a constraint.
Result<Blame> find_blame(const Surface& surface, const Constraints& constraints, const Flattening& flattening,
                         const FlattenOptions& options, double seconds, const Monitor& monitor);

}  // namespace planish
