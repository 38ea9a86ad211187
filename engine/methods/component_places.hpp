// Where the components of a map go that is known up to similarities, or up to isometries.
#pragma once

#include "engine/methods/method.hpp"

namespace planish {

/// Turns components so that directions against the u axis and relations between components hold, scales those with two pins onto
/// them, and moves those with one.   any_size: the map may be scaled;  uv [V] in and out, units of the ordered mesh
/// Fails: ConstraintUnsupported where a component's pins or directions ask for more than a similarity (an isometry) gives.
Result<void> place_components(const MapInput& input, bool any_size, Out<Vec2> uv);

/// Lays out the surface's triangles by their angles, and its components where they go.
///   angle [3 T or more, corners of the surface first] radians;  area [T or more] of the triangles, for the components' sizes
/// Fails: as lay_out_angles(), place_components().
Result<std::vector<Vec2>> lay_out_and_place(const MapInput& input, In<double> angle, In<double> area,
                                            bool any_size);

}  // namespace planish
