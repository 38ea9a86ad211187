// Maps of one surface under the same constraints by several methods, and what was measured on them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/model/flattening.hpp"

namespace planish {

/// What a map of the comparison is made by: a method under the constraints, or ARAP without any.
struct Contender {
  Method method = Method::Arap;
  bool constrained = true;
  bool operator==(const Contender&) const = default;
};

/// "unconstrained", or the method's name.
inline const char* name(const Contender& contender) {
  return contender.constrained ? name(contender.method) : "unconstrained";
}

/// What became of one of them.
struct ComparedMethod {
  Contender contender = {};
  bool supported = true;    ///< false: it cannot express one of the constraints
  std::string reason = {};  ///< why there is no map; "": there is one
  Flattening flattening = {};
  double conformal = 0;  ///< mean over the rest area of (s1 - s2)^2 / 2, DESIGN 3.8's stretches
  /// Of the constraint that is farthest from what is allowed: relative (allowed 1e-9), of angles in degrees (1e-7).
  std::optional<double> worst_residual = {};
  double seconds = 0;

  bool has_map() const { return reason.empty(); }
};

}  // namespace planish
