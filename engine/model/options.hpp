// Every tunable of flatten: unit, range, default.
#pragma once

#include <cstdint>
#include <optional>

namespace planish {

/// How a map is made: the families of the paper's section 4, and the two methods it proposes.
enum class Method {
  Arap,      ///< as rigid as possible, constraints exact (Liu et al. 2008; the paper, section 5)
  Lscm,      ///< least squares conformal map, two vertices pinned (Levy et al. 2002)
  Dncp,      ///< discrete natural conformal parameterization (Desbrun et al. 2002): the same energy and map
  Spectral,  ///< conformal map of least energy against its boundary's mass, nothing pinned (Mullen et al. 2008)
  Abf,       ///< angle-based flattening: corner angles nearest to the surface's (Sheffer et al. 2005)
  Yamabe,    ///< conformal scale factors, the outer boundary keeps its lengths (Springborn et al. 2008)
  Deform,    ///< the map without constraints, deformed until it meets them (the paper, section 6)
};

const char* name(Method method);

/// Where the first rotations come from (DESIGN 3.1).
enum class Init {
  Uniform,    ///< minimum-norm connection, every dual edge counts the same (the paper)
  Cotangent,  ///< minimum-norm connection, weighted by 1 / max(cotangent weight, 1e-3 of their mean)
  Harmonic,   ///< closest rotations of a harmonic map onto a disk (for comparison)
  Identity,   ///< triangles unfolded along a spanning tree without extra rotation (for comparison)
};

/// The energy that is minimised.
enum class Energy {
  Arap,                ///< as rigid as possible, and a barrier against flips where these are to be removed
  SymmetricDirichlet,  ///< |J|^2 + |J^-1|^2: keeps areas and angles alike, never flips
};

const char* name(Energy energy);

/// What is done about flipped triangles (DESIGN 3.6).
enum class Flips {
  Untangle,    ///< removed by minimising a regularised energy, then kept out of the minimum
  Weights,     ///< the paper's procedure: flipped triangles weigh more from global step to global step
  Stiffening,  ///< local stiffening (Bommes et al. 2009): so do distorted triangles and their neighbours
  Keep,        ///< nothing
};

const char* name(Flips flips);

/// What is done about parts of the map that lie on one another.
enum class Overlapping {
  Report,  ///< nothing
  Remove,  ///< another map is sought, and kept from crossing itself
};

const char* name(Overlapping overlapping);

struct FlattenOptions {
  /// Others than Arap refuse what has no meaning for them where it is not as it is here.
  Method method = Method::Arap;
  Init init = Init::Uniform;
  Energy energy = Energy::Arap;
  Flips flips = Flips::Untangle;
  std::optional<Overlapping> overlaps = {};  ///< unset: removed where flips are untangled, else reported
  double tolerance = 1e-6;                   ///< of the gradient (DESIGN 3.5), > 0
  int max_iterations =
      500;  ///< steps after the first global solve, >= 0; removing overlaps: twice as many again
  /// The paper's own variant: directions of features as the first rotations have them, flipped triangles weigh more from
  /// global step to global step until none is left, triangles at features keep their first rotations.
  bool paper = false;
  bool keep_directions = false;  ///< features keep the directions of the first rotations: no refit
  bool normalize = false;        ///< scale and move uv into the unit square
  int threads = 0;               ///< 0: the arena of the calling thread
  /// Bytes that the process may hold, 0: no matter. Methods are chosen that fit by estimate; where none does, that is said
  /// before the memory is taken.
  std::int64_t memory_limit = 0;
};

/// What options say about overlaps, or mean where they do not say.
Overlapping overlapping(const FlattenOptions& options);

/// What a map's triangles are compared with when it is deformed (DESIGN 3.7).
enum class Reference {
  Surface,           ///< triangles in space
  Parameterization,  ///< the map as it was given
};

const char* name(Reference reference);

/// Where constrained elements are in a deformed map.
enum class FeaturePoses {
  Held,  ///< where they lie nearest to the given map (the paper)
  Free,  ///< begun there, moved by what their constraints leave free to where the whole is least distorted
};

const char* name(FeaturePoses poses);

struct EditOptions {
  Reference reference = Reference::Surface;
  int threads = 0;  ///< 0: the arena of the calling thread
};

/// Of one solve of an edited map.
struct SolveOptions {
  int steps = 1;  ///< the constrained elements go their way in so many steps, >= 1; the rest follows each
  FeaturePoses poses = FeaturePoses::Held;  ///< of the last step
  Energy energy = Energy::Arap;
  Flips flips = Flips::Untangle;  ///< Untangle or Keep
  Overlapping overlaps = Overlapping::Report;
  double tolerance = 1e-6;   ///< of the gradient (DESIGN 3.5), > 0
  int max_iterations = 500;  ///< local/global and Newton steps of the last step, >= 0
};

}  // namespace planish
