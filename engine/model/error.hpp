// Failure as a value: a code with one meaning, the offending elements, the place, and words made in one
// function.
#pragma once

#include <string>
#include <vector>
#include <tl/expected.hpp>

#include "kernels/base/types.hpp"

namespace planish {

enum class ErrorCode {
  InternalDefect,           ///< a defect of planish itself
  BadUsage,                 ///< an argument or option that has no meaning
  NotBuilt,                 ///< a part that this build leaves out
  CannotOpen,               ///< the file cannot be opened or read
  UnknownFormat,            ///< neither the name nor the first bytes tell a format
  BadSyntax,                ///< the file breaks its format; place and expectation say where
  Truncated,                ///< the file ends too early
  IndexOutOfRange,          ///< a face names a vertex that does not exist
  NoTriangles,              ///< nothing to flatten
  NonFinitePosition,        ///< a coordinate is not a number or infinite
  RepeatedVertex,           ///< a triangle names one vertex twice
  DuplicateTriangle,        ///< a triangle is listed twice
  DegenerateTriangle,       ///< zero area, or a needle below the precision of the coordinates
  NonManifoldEdge,          ///< an edge with more than two triangles
  NonManifoldVertex,        ///< triangles that meet in a vertex without forming one fan
  InconsistentOrientation,  ///< neighbours that run along their common edge in the same direction
  NotOrientable,            ///< no choice of orientation agrees (a Moebius strip)
  ClosedComponent,          ///< a component without boundary
  HasHandles,               ///< a component of genus above 0
  TooLarge,                 ///< more than 2^31 half-edges
  NoParameterization,       ///< a mesh without uv where its map is asked for
  ReportOfOtherMesh,        ///< a report whose counts are not those of the mesh
  FeatureTooFar,            ///< a point of a polyline is farther from the surface than its max_distance
  FeatureLeavesSurface,     ///< a polyline crosses a boundary, or goes on where there is no surface
  FeatureBroken,            ///< a feature that is no chain: too few points, repeated ones, a gap
  FeaturesOverlap,          ///< two features run along one edge in opposite directions
  RegionBroken,             ///< a region that is not connected, not bounded by edges, or empty
  ConstraintInvalid,        ///< a constraint that names what does not exist or does not fit its feature
  ConstraintsConflict,      ///< constraints that cannot all hold
  ConstraintUnsupported,    ///< a constraint that the method cannot express
  FactorizationFailed,      ///< the matrix is not positive definite
  ResidualTooLarge,         ///< rotations do not meet their rows
  NoConvergence,            ///< an eigenvector, or directions of features, that iteration does not find
  OutOfMemory,              ///< memory could not be had
  CannotWrite,              ///< an output file could not be written
  Cancelled,                ///< stopped by the caller
};

/// What the ids of an error count.
enum class ElementKind { None, Vertex, Triangle, Edge, Component, Property, Point, Constraint };

/// Where in a file. Lines and columns count from 1; byte from 0 (kNone where lines are the better place).
struct Place {
  std::string file;
  Offset line = 0;
  Offset column = 0;
  Offset byte = kNone;
  std::string pointer = {};  ///< JSON pointer of the place in a constraint file: "/features/sill"
};

/// At most kMaxListedIds ids are kept (edges: pairs of vertices, both counted); `count` is the number of all
/// elements.
inline constexpr std::size_t kMaxListedIds = 64;

struct Error {
  ErrorCode code = ErrorCode::InternalDefect;
  std::string what = {};  ///< the sentence's core: what was expected and found
  Place place = {};       ///< file and position, where known
  ElementKind element = ElementKind::None;
  std::vector<Index> ids = {};  ///< 0-based, as in the input file
  Offset count = 0;
  std::string also = {};  ///< further faults, said after the ids
};

template <class T>
using Result = tl::expected<T, Error>;
using Failure = tl::unexpected<Error>;

inline Failure fail(Error error) { return Failure(std::move(error)); }
inline Failure fail(ErrorCode code, std::string what) {
  return Failure(Error{.code = code, .what = std::move(what)});
}

/// Stable lower-case name, e.g. "non-manifold-edge".
const char* name(ErrorCode code);
const char* name(ElementKind element);

/// What the user can do about it, or "".
const char* remedy(ErrorCode code);

/// Exit code of the program (DESIGN 4.1): 1 defect, 2 usage, 3 cannot read, 4 mesh, 5 constraints, 7 cannot write, 130
/// stopped.
int exit_code(ErrorCode code);

/// One line: place, what, first ids and their number, remedy, [code].
std::string describe(const Error& error);

}  // namespace planish
