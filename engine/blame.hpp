// Where flips or overlaps remain: which features are there, and which constraint makes the difference.
#pragma once

#include "engine/flatten.hpp"

namespace planish {

struct Blame {
  /// Those with a vertex of a flipped triangle, or an overwound one; where there are none, of the first overlapping triangles.
  std::vector<std::string> features;
  std::vector<std::string> constraints;  ///< without any one of which there are none
  Index tried = 0;  ///< constraints left out, in the order of the file, until time was up
};

/// Leaves out one constraint after the other and flattens again, for as long as the time allows.
///   flattening: of these constraints, with flips, or without them and with overlaps
/// Fails: Cancelled.   Cost: a flattening a constraint.
Result<Blame> find_blame(const Surface& surface, const Constraints& constraints, const Flattening& flattening,
                         const FlattenOptions& options, double seconds, const Monitor& monitor);

}  // namespace planish
