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

/// Merges vertices at equal positions (merged ones stay, unreferenced), drops triangles that name a vertex twice and
/// copies of triangles, removes degenerate triangles, turns triangles to one orientation, splits non-manifold vertices.
/// Attributes, uv sets and statements follow their elements. Defects that remain are for diagnose() to name.
/// Fails: NotBuilt without PLANISH_WITH_CGAL_GPL.  Cost: serial, O(T log T).
Result<Repair> repair(const Mesh& mesh);

}  // namespace planish
