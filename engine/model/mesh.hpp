// A triangle mesh as files know it: columns of positions and corners, and whatever else travels with it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// View of a triangle mesh; the caller's arrays, not copied.
struct Surface {
  In<Vec3> position;        ///< [V] mesh units
  In<Index> corner_vertex;  ///< [3 T] vertices of triangle t at 3 t, 3 t + 1, 3 t + 2
  Index num_vertices() const { return static_cast<Index>(position.size()); }
  Index num_triangles() const { return static_cast<Index>(corner_vertex.size() / 3); }
};

/// Number formats of an attribute, in the order of PLY's types.
enum class Scalar { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

inline constexpr std::size_t byte_size(Scalar scalar) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<int>(scalar)];
}

/// A column that planish does not interpret but keeps: colours, quality, labels. Native byte order.
struct Attribute {
  std::string name;
  Scalar scalar = Scalar::Float32;
  std::vector<std::byte> values;  ///< one scalar an element
};

/// A statement of an OBJ file (group, object, material, smoothing) in force from triangle `triangle` on;
/// verbatim.
struct Statement {
  Index triangle = 0;
  std::string text;
};

/// One parameterization found in a file.
struct UvSet {
  std::string name;             ///< spelling in the file: "st", "uv", "texture_uv", "texcoord", "vt"
  std::vector<Vec2> corner_uv;  ///< [3 T]
  bool per_vertex = false;      ///< every vertex has one uv only, as files with per-vertex spellings have
};

struct Mesh {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex;
  std::vector<UvSet> uv_sets;  ///< the first is the mesh's parameterization
  std::vector<Attribute> vertex_attributes;
  std::vector<Attribute> triangle_attributes;
  std::vector<Statement> statements;
  std::vector<std::string> comments;
  std::vector<std::string> warnings;  ///< what the reader met and left out

  Surface surface() const { return {position, corner_vertex}; }
  Index num_vertices() const { return static_cast<Index>(position.size()); }
  Index num_triangles() const { return static_cast<Index>(corner_vertex.size() / 3); }
};

}  // namespace planish
