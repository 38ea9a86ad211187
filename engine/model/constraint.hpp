// Constraints as a constraint file states them (DESIGN 3.2, 4.2): plain values, not yet checked against a mesh.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/model/feature.hpp"

namespace planish {

/// The size of a template against the feature in space: a given factor, or found by the solver.
struct Scale {
  std::optional<double> factor = 1;  ///< > 0; none: free
  std::string group;                 ///< features of one group share their free factor; "": alone
};

struct LineConstraint {
  enum class Lengths { Keep, Scale, Free };
  std::string feature;
  Lengths lengths = Lengths::Keep;
  Scale scale;  ///< where lengths are Scale
};

struct CircleConstraint {
  std::string feature;
  Scale scale{.factor = std::nullopt, .group = {}};
  std::optional<double> radius;  ///< mesh units, > 0; not together with a scale
  std::optional<double>
      sweep_degrees;  ///< of an arc, in (0, 360); none: that of its best-fit circle in space
  std::optional<bool> mirror;
};

/// What an angle is measured on.
enum class Measure { Line, Chord };

/// Angle, parallel (0 degrees) or perpendicular (90) between two features or two edges of the mesh.
struct AngleConstraint {
  std::vector<std::string> features;        ///< two, or none
  std::vector<std::array<Index, 2>> edges;  ///< two, or none
  std::optional<Measure> measure;           ///< of features; none: Line where it is one, else Chord
  double degrees = 0;                       ///< [0, 180], oriented: [0, 360)
  bool oriented = false;
};

/// Angle against the u axis.
struct DirectionConstraint {
  std::string feature;  ///< or "" where an edge is given
  std::optional<std::array<Index, 2>> edge;
  std::optional<Measure> measure;
  double degrees = 0;
  bool oriented = false;
};

struct CurveConstraint {
  enum class Shape { Plane, Geodesic };
  std::string feature;
  Shape shape = Shape::Plane;
  Scale scale;
  std::optional<bool> mirror;
};

struct RegionConstraint {
  std::string feature;
  Scale scale;
};

struct PinConstraint {
  std::vector<Index> vertex;
  std::vector<Vec2> uv;  ///< one a vertex, mesh units
};

struct Constraint {
  std::string name;  ///< given, or type and features
  std::string type;  ///< word of the file: "line", "perpendicular", ...
  std::variant<LineConstraint, CircleConstraint, AngleConstraint, DirectionConstraint, CurveConstraint,
               RegionConstraint, PinConstraint>
      rule;
};

/// A whole constraint file.
struct ConstraintSet {
  double agreement = 1e-3;  ///< DESIGN 3.2, near agreement; relative, >= 0
  std::string outer;        ///< feature that is the outer loop; "": the longest
  std::vector<FeatureSpec> features;
  std::vector<Constraint> constraints;
  std::vector<std::string> seams;  ///< names of features
};

}  // namespace planish
