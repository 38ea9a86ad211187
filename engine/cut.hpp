// The facade for cutting alone: a surface opened along seams, and further into disks where asked for.
#pragma once

#include <string>
#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

enum class CutMode {
  None,  ///< along the seams only
  Auto,  ///< and along a short graph that turns every component into a disk, or a disk with its holes
};

struct CutOptions {
  CutMode mode = CutMode::None;
  int threads = 0;  ///< 0: the arena of the calling thread
};

/// A surface that was opened: triangles and corners as before, vertices on the cut with copies.
struct Cut {
  std::vector<Vec3> position;        ///< [V'] the input's own V first, then the copies
  std::vector<Index> corner_vertex;  ///< [3 T]
  std::vector<Index> vertex_origin;  ///< [V'] vertex of the input
  Index edges = 0;                   ///< parted
  double length = 0;                 ///< of these, mesh units
  Index charts = 0;                  ///< components of the result

  Surface surface() const { return {position, corner_vertex}; }
};

/// Opens the surface along the chains whose names are in `seams`; the cut graph prefers sharp edges and features.
/// Fails: ConstraintInvalid (a seam that is a region, not among the features, or opens nothing); the defects of diagnose() but
///        ClosedComponent and HasHandles.
/// Cost: O(T log T).
Result<Cut> cut(const Surface& surface, const std::vector<Feature>& features,
                const std::vector<std::string>& seams, const CutOptions& options = {});

/// A surface that was opened where a map of it is torn, and the map: one uv a vertex.
struct OpenedMap {
  Cut cut;               ///< no edges where the map is whole and no seams were given
  std::vector<Vec2> uv;  ///< [V'] 0 0 for unreferenced vertices
};

/// Opens the surface along the edges whose two triangles have different uv at one of their ends, and along the seams.
///   corner_uv [3 T]
/// Fails: as cut(); BadUsage (size of corner_uv); NonFinitePosition (uv), naming triangles.   Cost: O(T log T).
Result<OpenedMap> cut_where_torn(const Surface& surface, In<Vec2> corner_uv,
                                 const std::vector<Feature>& features, const std::vector<std::string>& seams,
                                 int threads = 0);

}  // namespace planish
