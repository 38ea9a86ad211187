// Text cut at line ends into pieces of about one size, to be parsed independently.
#pragma once

#include <string_view>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "io/cursor.hpp"

namespace planish {

/// Bytes of a piece: some hundred microseconds to parse. Independent of the number of threads.
inline constexpr std::size_t kChunkBytes = std::size_t{1} << 18;

/// Pieces of at least kChunkBytes but the last, each a whole number of lines; a joined line end is no cut.
std::vector<std::string_view> line_chunks(std::string_view text, Dialect dialect,
                                          std::size_t chunk_bytes = kChunkBytes);

/// Lines with content (neither blank nor comment) before each chunk; the last entry is their total.
std::vector<Offset> rows_before(const Exec& exec, const std::vector<std::string_view>& chunks,
                                Dialect dialect);

}  // namespace planish
