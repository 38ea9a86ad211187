// Constraint files (DESIGN 4.2, docs/constraints.md, docs/constraints.schema.json).
#pragma once

#include <string>
#include <string_view>

#include "engine/exec/parallel.hpp"
#include "engine/model/constraint.hpp"
#include "engine/model/error.hpp"

namespace planish {

/// Reads a constraint file and the polyline files that it names; their paths are relative to its folder.
/// Names, types, ranges and references are checked; what needs the mesh (that an index exists, that a feature
/// is closed) is not.
/// Fails: CannotOpen; BadSyntax with file and JSON pointer (also line and column where the text is no JSON; in
/// a polyline file its line instead); ConstraintInvalid for a region where a curve is needed, or the reverse,
/// with the pointer; TooLarge; OutOfMemory.
Result<ConstraintSet> read_constraints(const Exec& exec, const std::string& path);

/// The same from text. `file` is used in errors only; polyline files are relative to `folder` ("": as given).
Result<ConstraintSet> parse_constraints(const Exec& exec, std::string_view text, const std::string& file,
                                        const std::string& folder);

}  // namespace planish
