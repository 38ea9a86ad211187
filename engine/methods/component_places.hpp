// Where the components of a map go that is known up to similarities, or up to isometries.
#pragma once

#include "engine/methods/method.hpp"

namespace planish {

/// Turns components so that directions against the u axis and relations between components hold, scales those with two pins onto
/// them, and moves those with one.   any_size: the map may be scaled;  uv [V] in and out, units of the ordered mesh
/// Fails: ConstraintUnsupported where a component's pins or directions ask for more than a similarity (an isometry) gives.
Result<void> place_components(const MapInput& input, bool any_size, Out<Vec2> uv);

}  // namespace planish
