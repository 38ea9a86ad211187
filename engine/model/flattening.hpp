// What flatten returns: the map, and the facts that a report states about it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// Minimum, maximum, area-weighted mean and percentiles of a quantity over the triangles.
struct Spread {
  double min = 0, max = 0, mean = 0, p1 = 0, p50 = 0, p99 = 0;
};

/// Facts about the mesh (DESIGN 4.3 "mesh").
struct MeshFacts {
  Index vertices = 0;  ///< all, unreferenced ones too
  Index unreferenced_vertices = 0;
  Index duplicate_positions =
      0;  ///< used vertices at the position of an earlier one; 0 where there is one component
  Index triangles = 0;
  Index components = 0;
  Index boundary_loops = 0;
  Index euler = 0;           ///< V - E + F of the referenced part
  std::vector<Index> outer;  ///< per component, the number of its outer loop (loops by decreasing length)
  Index mollified_triangles = 0;  ///< needles whose weights were floored (see kernels/intrinsic/cotangents)
};

/// A map in the figures of the parameterization benchmark of Shay, Solomon and Stein (2022). Surface and map are scaled to the
/// area 1 each, but for `resolution`; triangles count by their areas, turned over or not.
struct BenchmarkFigures {
  double max_area_distortion = 0;                         ///< largest a'/a + a/a' - 2 of a triangle's areas
  double average_area_error = 0;                          ///< sum of |a' - a|
  double min_singular_value = 0, max_singular_value = 0;  ///< of the Jacobians, without sign
  double proportion_flipped_triangles = 0;                ///< det J < 0, or > 0 where these are fewer
  double bijectivity_violation_area =
      0;  ///< surface area that other triangles' images lie on, once for each of them
  double max_angle_distortion = 0;  ///< largest s1/s2 + s2/s1 - 2
  double average_angle_error =
      0;  ///< mean over the area of a triangle's three |angle' - angle|, summed; radians
  double resolution =
      0;  ///< largest 1/s2 once the map fits into the unit square, unscaled surface; mesh units
};

/// Facts about a map, measured on its coordinates (DESIGN 3.8); energies and means per rest area.
struct Certificate {
  double arap = 0;
  double symmetric_dirichlet = 0;  ///< infinite with a flip
  Spread sigma_max, sigma_min, area_ratio, angle_distortion;
  Offset flipped_triangles = 0;      ///< det J <= 0, exact predicate
  Offset overwound_vertices = 0;     ///< interior vertices whose image angles sum to more than 2 pi
  Offset overlapping_pairs = 0;      ///< triangles without a common vertex whose images share interior points
  double overlap_area_fraction = 0;  ///< sum of the pairs' common areas over the area of the map
  std::vector<Index> flipped;        ///< their ids, ascending
  std::vector<Index> overwound;      ///< vertex ids, ascending
  std::vector<std::array<Index, 2>> overlapping;  ///< the first kMaxListedIds of the pairs
  BenchmarkFigures benchmark;
};

/// One step; iteration 0 is the first global solve.
struct Iterate {
  int iteration = 0;
  double energy = 0;                 ///< what the phase lowers, per rest area: arap, or that of FlipRemoval
  double gradient = 0;               ///< DESIGN 3.5
  Phase phase = Phase::LocalGlobal;  ///< LocalGlobal, Polish, or Separate
};

/// What was done so that no triangle is flipped and no vertex overwound.
struct FlipRemoval {
  Flips method = Flips::Keep;
  Offset flipped_before = 0, overwound_before = 0;  ///< where local/global steps ended
  double arap_before = 0;                           ///< there
  int patch_steps = 0;       ///< Newton steps in neighbourhoods, of the slowest one, added up
  int untangling_steps = 0;  ///< Newton steps of the whole away from flips
  int newton_steps = 0;      ///< of the whole down to the minimum
  double energy = 0;  ///< what was minimised there, per rest area: arap and barrier, or symmetric_dirichlet
  double barrier_weight = 0, barrier_delta = 0;  ///< DESIGN 3.6: mu and delta; 0 where there was none
};

/// What was done so that no parts of the map lie on one another.
struct OverlapRemoval {
  /// Map that the descent without overlaps began at.
  enum class Start {
    None,          ///< none was found, the map stayed as it was
    Straightened,  ///< the one that was reached, its boundary laid straight where it curled over itself
    FirstMap,      ///< that of the first rotations, or a given map with its features in their places
    ConvexMap,     ///< one of the whole onto a disk
    Unconstrained  ///< the map without constraints, or a given one, which they were brought to
  };
  Overlapping method = Overlapping::Report;
  Offset pairs_before = 0;   ///< where the descent without flips ended
  double energy_before = 0;  ///< what that lowered, there, per rest area
  Start start = Start::None;
  int newton_steps = 0;  ///< of the descent, to the map it began at too
  double energy =
      0;  ///< what was minimised, per rest area: that of FlipRemoval and the barrier between boundaries
};

const char* name(OverlapRemoval::Start start);

/// What became of one constraint (DESIGN 4.3 "constraints"); of one on a seam there are two, a side each.
struct ConstraintOutcome {
  std::string name, type = {};
  std::vector<std::string> features = {};
  std::vector<std::array<Index, 2>> edges = {};  ///< of relations between edges
  std::vector<Index> pinned = {};                ///< of a pin, its vertices as in the file
  int side = 0;                                  ///< of a seam: 1 left of the feature, 2 right
  double residual = 0;                           ///< DESIGN 3.8, on the final coordinates; relations: degrees
  double residual_abs = 0;                       ///< the same in mesh units (relations: in degrees)
  std::optional<double> scale = {};              ///< of the template in the plane
  std::optional<double> orientation = {};        ///< of the template, degrees; of a line its direction
  std::optional<double> degrees = {};  ///< of a relation: the angle from the first to the second, as chosen
  std::vector<Vec2> shape = {};        ///< the template at scale 1, mesh units; empty: none
  bool mirrored = false;
  bool chirality_open = false;  ///< the surface did not tell which way round; the better one was taken
  std::optional<double> planarity =
      {};  ///< farthest vertex from its plane, mesh units; of a region: worst stretch - 1
  std::string yielded_to = {};      ///< the constraint that it yielded to most
  double mismatch = 0;              ///< by how much it yielded to features of higher rank, mesh units
  std::vector<Index> yielded = {};  ///< vertices where it did
  bool keeps_order = true;          ///< of a line: no edge runs backwards
};

/// What constraints left free, and what the solver made of it.
struct ConstraintFacts {
  std::vector<ConstraintOutcome> outcome;  ///< in the order of the file
  Index bodies = 0, assemblies = 0, clusters = 0;
  Index border_unknowns = 0;  ///< free scales, orientations, places along lines
  Offset factor_nonzeros = 0;
};

struct StepTime {
  std::string step;
  double seconds = 0;
};

/// Of yamabe where edges had to be flipped: the flat metric is that of another triangulation on the mesh's vertices.
struct IntrinsicFacts {
  Index moved_edges = 0;    ///< of the mesh (and of what fills its holes) that are no edges there
  double angle_defect = 0;  ///< largest difference of a sum of angles there from what it is to be, radians
};

struct Flattening {
  Method method = Method::Arap;
  std::vector<std::string>
      up_to_scale;  ///< constraints whose shapes the method keeps, but not their given sizes
  std::optional<IntrinsicFacts> intrinsic;
  std::vector<Vec2> uv;  ///< [V] mesh units; 0 0 for unreferenced vertices
  MeshFacts mesh;
  Certificate certificate;
  std::vector<Iterate> history;
  int iterations = 0;
  bool converged = false;
  double gradient = 0;  ///< of the last iterate
  double holonomy_residual =
      0;  ///< largest residual of the rotation rows, radians (0 where none were solved)
  FlipRemoval removal;
  OverlapRemoval overlaps;
  ConstraintFacts constraints;  ///< empty where there are none
  std::vector<StepTime> timings;
  int threads = 1;
};

}  // namespace planish
