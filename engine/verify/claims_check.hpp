// The numbers of a report against those of the map.
#pragma once

#include "engine/model/verification.hpp"
#include "engine/verify/written_map.hpp"

namespace planish {

/// A sentence for each number that the report states otherwise than `found` has it: counts and ids exactly, energies, stretch
/// and lengths of chains to 1e-9 of their size.
///   rounding: relative, of the shortest edge in the coordinates of the mesh
std::vector<std::string> misreported(const Claims& claims, const Verification& found, const MeshFacts& facts,
                                     const WrittenMap& map, double rounding);

}  // namespace planish
