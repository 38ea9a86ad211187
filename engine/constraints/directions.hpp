// How bodies that share a vertex lie to one another on the surface: the start of their directions.
#pragma once

#include "engine/constraints/agreement.hpp"
#include "engine/constraints/poses.hpp"
#include "engine/constraints/vertex_bodies.hpp"

namespace planish {

/// Direction of each body against the first one of its assembly, radians: at a shared vertex the angles between the
/// bodies' edges on the surface, the star scaled to 2 pi inside; where a template was fitted to another one, as it lies
/// there.   Cost: O(joints).
std::vector<double> surface_directions(const RestSurface& rest, const Compiled& compiled,
                                       const VertexBodies& vertex_bodies, const Agreement& agreement);

}  // namespace planish
