// Random meshes and random constraint sets on them that can be met by construction.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <vector>

#include "engine/flatten.hpp"
#include "engine/model/constraint.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// What a case is made from. Every seed in `items` is a feature, a relation or a pin of its own; one that does not fit the
/// earlier ones is left out, so that any part of them makes a case too.
struct CaseSeeds {
  std::uint32_t mesh = 0;
  Index triangles = 400;  ///< about
  std::vector<std::uint32_t> items;
};
std::ostream& operator<<(std::ostream& os, const CaseSeeds& seeds);

/// A mesh whose features are chains and blocks of a grid.
struct ConstrainedCase {
  Mesh mesh;
  ConstraintSet set;
  std::vector<Feature> features;

  Constraints constraints() const { return {&set, &features, {}}; }
  const Feature& feature(const std::string& name) const;
};
std::ostream& operator<<(std::ostream& os, const ConstrainedCase& c);

/// A square or a frame with a hole, flat or with smooth waves, vertices at random in their cells.
struct GridMesh {
  Mesh mesh;
  Index columns = 0, rows = 0;          ///< of vertices
  Index hole[4] = {0, 0, 0, 0};         ///< vertices (i0, j0) to (i1, j1) of its rim; all 0: none
  std::vector<Index> vertex_at;         ///< [columns * rows] kNone in the hole
  std::vector<Index> triangle_of_cell;  ///< [(columns - 1) * (rows - 1)] first of two, kNone in the hole
  Index at(Index i, Index j) const { return vertex_at[static_cast<std::size_t>(j) * columns + i]; }
  bool has_hole() const { return hole[2] > 0; }
};
GridMesh random_grid(std::uint32_t seed, Index triangles);

/// Features hang together as trees, angles are those of directions near the surface's own, pins lie near where one would
/// expect them: so every set can be met.
ConstrainedCase feasible_case(const CaseSeeds& seeds);

/// Names of the kinds of contradictions that contradictory_case() makes.
inline constexpr int kNumContradictions = 10;
const char* contradiction_name(int kind);

/// A feasible case and one contradiction; `named` receives the constraints that an error has to name.
ConstrainedCase contradictory_case(const CaseSeeds& seeds, int kind, std::vector<std::string>& named);

/// The same case moved, relabelled (new_of_old [V] out), scaled.
ConstrainedCase rigid_motion(const ConstrainedCase& c, std::uint64_t seed);
ConstrainedCase relabelled(const ConstrainedCase& c, std::uint64_t seed, std::vector<Index>& new_of_old);
ConstrainedCase scaled(const ConstrainedCase& c, double factor);

}  // namespace planish
