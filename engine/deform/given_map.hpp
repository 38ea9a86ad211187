// A parameterization that somebody else made, brought to the surface's units, and how its components lie.
#pragma once

#include "engine/constraints/fit.hpp"
#include "engine/workpiece.hpp"

namespace planish {

struct GivenMap {
  std::vector<Vec2> uv;    ///< [V] of the ordered mesh, in its units
  double scale = 1;        ///< what it was multiplied with to come to mesh units
  Index num_mirrored = 0;  ///< components that were turned over, each in its place
};

/// A map whose area is more than 4 times, or less than a quarter of the surface's is in units of its own (the unit square of
/// textures) and is scaled to the surface's area; others keep their size. Components that lie with their back up are mirrored.
///   uv [input V] mesh units or others
/// Fails: BadUsage (another number of uv); NonFinitePosition, naming vertices; NoParameterization where the map of a
/// component has no area.
Result<GivenMap> take_map(const Workpiece& piece, In<Vec2> uv);

/// Rest shapes of triangles as a map has them.
///   uv [V] units of the ordered mesh
/// Fails: DegenerateTriangle, naming those without area.
Result<Geometry> geometry_of_map(const Exec& exec, const Workpiece& piece, In<Vec2> uv);

/// Per component the isometry of the map onto the pins in it: where these ask for another place of the whole more than for
/// a deformation (one pin; or one isometry takes away nine tenths of the distances, in the mean of squares).
///   pins: distinct vertices
std::vector<Placement> onto_pins(In<Pin> pins, In<Index> vertex_component, Index num_components, In<Vec2> uv);

/// Per component a turn by an angle about its middle, or its pin.   by [components] radians
std::vector<Placement> turns(In<double> by, In<Pin> pins, In<Index> vertex_component, In<Vec2> uv);

/// z -> p + c z, each vertex with its component.
void move_components(In<Placement> motion, In<Index> vertex_component, Out<Vec2> uv);

/// How a component may be moved.
enum class Freedom { None, Shift, Isometry };

/// What takes each component of one map nearest to another one.   freedom [components]
std::vector<Placement> onto_map(In<Freedom> freedom, In<Index> vertex_component, In<Vec2> from, In<Vec2> to);

}  // namespace planish
