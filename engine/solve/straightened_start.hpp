// From a map whose boundary curls over itself here and there to one where it does not, the rest left as it is.
#pragma once

#include <functional>
#include <optional>

#include "engine/solve/driver.hpp"
#include "engine/solve/map_energy.hpp"

namespace planish {

/// The triangles of a map that lie on others, ascending.
using FindOverlapping = std::function<std::vector<Index>(In<Vec2> uv)>;

/// Lays runs of the boundary near overlaps along shallow arcs between their ends, and the neighbourhood, its rim held, anew
/// without flips; in larger and larger neighbourhoods. Where none overlap any more they are brought down to the minimum of the
/// density, all around them held and the problem's barrier, if there is one, between boundaries. Vertices of features stay
/// where they are.
///   problem: all but its global phase;  uv [V]: without flips
/// None where overlaps remain.   Fails: Cancelled, OutOfMemory.
/// Cost: some tens of Newton steps of the neighbourhoods.
Result<std::optional<std::vector<Vec2>>> straighten_boundary(const Exec& exec, const ArapProblem& problem,
                                                             const MapDensity& density,
                                                             const FindOverlapping& find,
                                                             const Monitor& monitor, In<Vec2> uv, int& steps);

}  // namespace planish
