// What a report claims about a written map, and what was found in the map itself.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/model/feature.hpp"
#include "engine/model/flattening.hpp"

namespace planish {

/// The part of a report that can be held against the mesh it was written with, in the numbers of that mesh.
struct Claims {
  MeshFacts mesh;                              ///< vertices, triangles, components, boundary_loops, euler
  std::optional<Index> cut_edges;              ///< none where nothing was cut
  std::vector<Feature> features;               ///< chains and regions
  std::vector<ConstraintOutcome> constraints;  ///< in the order of the report
  Certificate certificate;                     ///< of its ids the first, as listed
};

/// What was found about one constraint; of one on a seam there are two, a side each.
struct ConstraintFinding {
  std::string name, type;
  int side = 0;
  bool degrees = false;                  ///< unit of the residual; else relative, DESIGN 3.8
  std::optional<double> residual = {};   ///< from the map; none where it cannot be had
  double allowed = 0;                    ///< up to here it is met
  std::string unmeasured = {};           ///< why there is no residual although nothing is wrong
  std::vector<std::string> faults = {};  ///< a sentence each
};

struct Verification {
  Index triangles = 0;
  Index charts = 0;      ///< components of the flat surface
  Index torn_edges = 0;  ///< edges whose two triangles lie apart in the map
  Certificate certificate;
  std::vector<std::array<Index, 2>> overlapping;  ///< the first pairs of triangles, ascending
  std::vector<ConstraintFinding> constraints;
  std::vector<std::string> faults;  ///< where the report and the map, or the report and the constraints, part

  /// Nothing flipped, overwound or overlapping, every constraint met, nothing misreported.
  bool holds() const;
};

inline bool Verification::holds() const {
  const bool injective = certificate.flipped_triangles == 0 && certificate.overwound_vertices == 0 &&
                         certificate.overlapping_pairs == 0;
  return injective && faults.empty() &&
         std::ranges::all_of(constraints, [](const ConstraintFinding& c) { return c.faults.empty(); });
}

}  // namespace planish
