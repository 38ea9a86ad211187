// Everything that is wrong with a mesh, found in one pass, with ids.
#pragma once

#include <string>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// One kind of defect with its elements. ids as in Error (at most kMaxListedIds; an edge is two vertex ids).
struct Defect {
  ErrorCode code = ErrorCode::InternalDefect;
  ElementKind element = ElementKind::None;
  std::vector<Index> ids;
  Offset count = 0;
  std::string what = {};  ///< instead of the usual sentence of its code, where that would not be true
};

/// What a mesh is and what is wrong with it.
struct Diagnosis {
  Index vertices = 0, triangles = 0;
  Index unreferenced_vertices = 0;
  Index duplicate_positions = 0;     ///< referenced vertices at the position of an earlier one (not a defect)
  Index components = 0;              ///< edge-connected
  Index boundary_loops = 0;          ///< 0 where edges are not manifold
  std::vector<double> loop_lengths;  ///< decreasing, mesh units
  Index boundary_edges = 0;
  Index euler = 0;  ///< V - E + F of the referenced part
  Index genus =
      0;  ///< summed over components; kNone where edges or vertices are not manifold or not orientable
  double area = 0;
  Vec3 lower, upper;                    ///< bounding box of referenced finite vertices
  double min_angle = 0, max_angle = 0;  ///< radians, over triangles of positive area
  std::vector<Defect> defects;          ///< most basic first; empty: can be flattened

  bool usable() const { return defects.empty(); }
};

/// Fails: never for indices in range; IndexOutOfRange, TooLarge (nothing else can be said then).
/// Cost: O(T log T) in parallel, some 60 bytes a triangle.
Result<Diagnosis> diagnose(const Exec& exec, const Surface& surface);

/// Whether a surface can carry features and be cut: no defect but closed components and handles.
/// Fails: the first other defect, as refusal() says it; what diagnose() fails with.
Result<void> check_manifold(const Exec& exec, const Surface& surface);

/// The first defect as an error that also names the other kinds; call only when !usable().
Error refusal(const Diagnosis& diagnosis);

}  // namespace planish
