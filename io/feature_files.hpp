// Polylines from files: lines of an OBJ, edges of a PLY, points of a CSV.
#pragma once

#include <string>
#include <string_view>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/feature.hpp"

namespace planish {

/// Reads one polyline from .obj, .ply, .csv, .txt or .xyz (the last three: points), each also with .gz.
/// max_distance stays empty; `closed` says whether the polyline returns to its start.
/// Fails: CannotOpen; BadSyntax (other extensions too), Truncated, IndexOutOfRange with file and line (binary
/// PLY: byte); segments that do not form one polyline: BadSyntax that lists the vertices to blame; TooLarge.
Result<PolylineSource> read_feature_file(const Exec& exec, const std::string& path);

/// The parsers; `file` is used in errors only.
/// OBJ: `v` and `l` (v, v/vt, negative indices); lines that meet at the ends are joined, in any order and
/// direction. Other statements are passed over.
Result<PolylineSource> parse_polyline_obj(std::string_view text, const std::string& file);
/// PLY, ascii or binary: element vertex with x y z, element edge with vertex1 and vertex2, joined likewise.
Result<PolylineSource> parse_polyline_ply(const Exec& exec, std::string_view bytes, const std::string& file);
/// A point a line, its numbers separated by commas, semicolons or blanks; a first line that does not begin
/// with a number is a header, '#' begins a comment. Closed when the last point is the first one again.
Result<PolylineSource> parse_polyline_csv(std::string_view text, const std::string& file);

}  // namespace planish
