// Elimination order of the vertices of a filled surface.
#pragma once

#include "engine/methods/filled_surface.hpp"
#include "engine/workpiece.hpp"

namespace planish {

/// That of the piece where nothing was filled.   Fails: OutOfMemory.
Result<std::vector<Index>> filled_order(const Exec& exec, const Workpiece& piece,
                                        const FilledSurface& filled);

}  // namespace planish
