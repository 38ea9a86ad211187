// What flatten's steps take, before they take it.
#pragma once

#include <string>

#include "engine/model/error.hpp"

namespace planish {

/// Largest resident size of the process up to some steps, bytes, the caller's mesh included. Estimates from measurements, good
/// to a tenth for meshes of more than 100,000 triangles; see perf/README.md.
struct MemoryNeed {
  Offset local_global = 0;
  Offset at_once = 0;  ///< the same where the start has two systems, analysed at the same time
  Offset newton =
      0;  ///< Newton steps of the whole: where flips have to be removed, or local/global hardly advances
};

/// Of checks and elimination order alone.
Offset memory_of_checks(Index num_triangles);

/// factor_nonzeros: of the sparse Cholesky factor;   border: dense columns beside it
MemoryNeed memory_need(Index num_triangles, Offset factor_nonzeros, Index border);

/// Fails: OutOfMemory where so much is more than the limit (0: there is none). what: names what needs it.
Result<void> within_memory(Offset needed, Offset limit, const std::string& what);

}  // namespace planish
