// Reports of flatten (docs/report.schema.json) read back, as far as the mesh they were written with can tell if they are true.
#pragma once

#include <string>
#include <string_view>

#include "engine/exec/parallel.hpp"
#include "engine/model/error.hpp"
#include "engine/model/verification.hpp"

namespace planish {

/// Of the mesh that a report has to fit.
struct MeshSize {
  Index vertices = 0, triangles = 0;
};

/// Keys that claim nothing about the map are passed over.
/// Fails: CannotOpen; BadSyntax with file and JSON pointer (also line and column where the text is no JSON): a key missing,
///        of another type or version, a report of embed; ReportOfOtherMesh where the counts differ; IndexOutOfRange with the
///        pointer of an id that the mesh does not have; TooLarge; OutOfMemory.
Result<Claims> read_report(const Exec& exec, const std::string& path, MeshSize mesh);

/// The same from text; `file` is used in errors only.
Result<Claims> parse_report(std::string_view text, const std::string& file, MeshSize mesh);

}  // namespace planish
