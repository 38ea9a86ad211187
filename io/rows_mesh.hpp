// From the rows of elements "vertex" and "face" to a mesh.
#pragma once

#include "io/rows.hpp"

namespace planish {

/// Positions x y z; faces cut into triangles; uv sets; all other scalar properties as attributes. Lists and
/// elements of other names are left out, each with a warning.
/// Fails: BadSyntax (no vertices, no x y z,
/// unusable faces), IndexOutOfRange, TooLarge, each with its place.
Result<Mesh> mesh_of_rows(const Exec& exec, const RowSource& source,
                          const std::vector<ElementRows>& elements);

}  // namespace planish
