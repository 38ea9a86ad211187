// What is asked of one constraint: by the constraint file or, without one, as far as a report itself says.
#pragma once

#include "engine/model/constraint.hpp"
#include "engine/model/flattening.hpp"

namespace planish {

struct Prescription {
  enum class Shape { Unknown, Plane, Geodesic };

  bool of_file = false;
  std::string name, type;
  std::vector<std::string> features = {};
  std::vector<std::array<Index, 2>> edges = {};
  std::vector<Index> pinned = {};
  std::vector<Vec2> pin_uv = {};     ///< one a pinned vertex; empty: not known
  std::optional<double> scale = {};  ///< none: free or not known
  std::string scale_group = {};
  bool free_lengths = false;  ///< of a line
  std::optional<double> radius = {}, sweep_degrees = {};
  std::optional<bool> mirror = {};
  Shape shape = Shape::Unknown;         ///< of a curve
  std::optional<Measure> measure = {};  ///< of a relation
  std::optional<double> degrees = {};   ///< of a relation; none: not known
  bool oriented = false;

  bool is_relation() const {
    return type == "angle" || type == "parallel" || type == "perpendicular" || type == "direction";
  }
};

Prescription prescription_of(const Constraint& constraint);

/// The report does not repeat what the file asks for: scales, angles but those of parallel and perpendicular, pins.
Prescription prescription_of(const ConstraintOutcome& entry);

}  // namespace planish
