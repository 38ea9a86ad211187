// Triangles that close the holes of a surface, by CGAL.
#pragma once

#include "engine/methods/filled_surface.hpp"

namespace planish {

struct HolePatches {
  std::vector<Vec3> position;        ///< of the vertices that are added
  std::vector<Index> corner_vertex;  ///< [3 T] added ones are numbered behind those of the surface
  std::vector<Index> unfilled;       ///< loops that could not be closed
};

/// loops: those to be closed.
HolePatches patch_holes(const Surface& surface, const Topology& topology, In<Index> loops);

}  // namespace planish
