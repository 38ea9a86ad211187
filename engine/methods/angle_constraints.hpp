// Constraints as conditions on the corner angles of a flat map: straight lines and the angles between them.
#pragma once

#include "engine/constraints/system.hpp"
#include "engine/methods/angle_rows.hpp"
#include "engine/methods/filled_surface.hpp"

namespace planish {

/// At every inner vertex of a chain that is to be straight: the angles on one side of it sum to pi.
/// Pre: all chains are lines of free lengths, or chords.
std::vector<std::pair<Index, AngleRow>> straight_rows(const FilledSurface& filled, const Compiled& compiled);

/// The angle from the direction of body a to that of body b as a sum over the corners along a strip of triangles between them,
/// the shortest one: terms, and minus what is to be added to them as target.   relation is left open
/// None where they lie on different components.   Cost: O(T).
std::optional<LongAngleRow> direction_row(const FilledSurface& filled, const Compiled& compiled, Index a,
                                          Index b);

/// A row for each relation that is within one component, directions against the u axis as relations to the first of them;
/// targets are those that a map chose, in the turn nearest to its angles.
///   chosen: of each relation, radians;  angle [3 T] of the filled surface, of that map
std::vector<LongAngleRow> relation_rows(const FilledSurface& filled, const Compiled& compiled,
                                        In<double> chosen, In<double> angle);

}  // namespace planish
