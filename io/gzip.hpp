// gzip streams in memory, by zlib.
#pragma once

#include <string>
#include <string_view>

#include "engine/model/error.hpp"
#include "io/buffer.hpp"

namespace planish {

/// Inflates one or several gzip members that follow each other.
/// Fails: Truncated, BadSyntax (both with the byte of the compressed stream reached), OutOfMemory.
Result<Buffer> inflate_gzip(std::string_view compressed, const std::string& file);

/// One gzip member, without a time stamp: the same content gives the same bytes.
/// Fails: OutOfMemory.
Result<std::string> deflate_gzip(std::string_view content, const std::string& file);

}  // namespace planish
