// Mends what can be mended without guessing, and says what it did (CGAL behind it).
#pragma once

#include <string>
#include <vector>

#include "engine/model/error.hpp"
#include "engine/model/mesh.hpp"

namespace planish {

/// One kind of mending, e.g. {"turned triangles", 47, {ids...}}.
struct Mending {
  std::string what;
  Offset count = 0;
  std::vector<Index> ids;  ///< triangles or vertices of the input, at most kMaxListedIds
};

struct Repair {
  Mesh mesh;                           ///< original vertices first, in order; split copies after them
  std::vector<Index> vertex_origin;    ///< [V'] vertex of the input each vertex stands for
  std::vector<Index> triangle_origin;  ///< [T'] triangle of the input
  std::vector<Mending> mendings;       ///< empty: nothing had to be done
};

/// Merges vertices at equal positions where open edges then meet (merged ones stay, unreferenced; left apart
/// where a third triangle would join an edge), drops triangles that name a vertex twice, copies of triangles
/// and flaps without thickness, turns the smaller part of every sheet that disagrees with itself, splits
/// non-manifold vertices, removes triangles without area. Attributes, uv sets and statements follow their
/// elements. What remains (edges of three triangles, Moebius strips, coordinates that are no numbers) is for
/// diagnose() to name.
/// Fails: IndexOutOfRange; NotBuilt where a triangle without area is to be removed and planish was built
/// without PLANISH_WITH_CGAL_GPL.
/// Cost: serial, O(T log T).
Result<Repair> repair(const Mesh& mesh);

}  // namespace planish
