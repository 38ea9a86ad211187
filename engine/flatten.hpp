// The facade: a mesh in, its flattening and a certificate out.
#pragma once

#include "engine/model/error.hpp"
#include "engine/model/flattening.hpp"
#include "engine/model/mesh.hpp"
#include "engine/model/monitor.hpp"
#include "engine/model/options.hpp"

namespace planish {

/// Flattens every component as rigidly as possible (ARAP) and lays the components out side by side.
/// The surface's arrays are read, not kept. Concurrent calls are allowed.
/// Fails: BadUsage (an option out of range); IndexOutOfRange, TooLarge and the defects of diagnose();
/// OutOfMemory;
///        Cancelled.
/// Cost: at 909k triangles 14 to 17 s on 2 shared cores; see perf/README.md.
/// Ref: Liu et al. 2008 (energy, local/global); Vaitkus and Varady (rotations first).
Result<Flattening> flatten(const Surface& surface, const FlattenOptions& options = {},
                           const Monitor& monitor = {});

}  // namespace planish
