// The header of a PLY file: its elements with their properties, and how the rows are written.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/model/error.hpp"
#include "io/rows.hpp"

namespace planish {

struct PlyHeader {
  std::vector<Element> elements;
  std::vector<std::string> comments;
  bool text = false, swapped = false;
  std::size_t size = 0;  ///< bytes
};

/// Fails: BadSyntax, Truncated with line and column.
Result<PlyHeader> parse_ply_header(std::string_view bytes, const std::string& file);

}  // namespace planish
