// A run of lines of an OBJ file, parsed without knowledge of the lines before it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/model/error.hpp"
#include "io/cursor.hpp"

namespace planish {

inline constexpr Dialect kObjDialect{.comments = true, .continued_lines = true};

/// Indices that faces name, as far as a chunk can tell: absolute ones from 0, negative ones from the first
/// element of the chunk. Never in range: kNeverInRange (index 0 in the file) and the largest Index.
struct ObjIndices {
  static constexpr Index kNeverInRange = std::numeric_limits<Index>::min();
  std::vector<Index> value;     ///< one a corner
  std::vector<Index> relative;  ///< corners that count from the chunk's first element, ascending
};

struct ObjStatement {
  std::string_view text;
  Index corners_before = 0, faces_before = 0;  ///< in the chunk
};

/// What is wrong with a line, and where.
struct ObjFault {
  ErrorCode code = ErrorCode::BadSyntax;
  std::string what;
  const char* position = nullptr;
};

struct ObjChunk {
  std::vector<Vec3> position;
  std::vector<Vec3> colour;  ///< of the vertices that have one
  std::vector<Vec2> uv;
  ObjIndices corner_vertex;
  ObjIndices corner_uv;  ///< value[c] = kNone where a corner has none
  Index corners_with_uv = 0;
  Offset normals = 0;           ///< lines of them, which are not read
  std::vector<Index> face_end;  ///< corners up to the end of each face
  std::vector<ObjStatement> statements;
  std::optional<ObjFault> fault;  ///< parsing stopped here
};

ObjChunk parse_obj_chunk(std::string_view text);

/// Where a chunk's faces name a vertex (or its texture coordinate) at a corner.
const char* find_obj_index(std::string_view text, Index corner, bool of_uv);

}  // namespace planish
