#include "engine/methods/filled_surface.hpp"

#include "engine/methods/hole_patches.hpp"

namespace planish {
namespace {

std::vector<Index> loops_to_close(const Topology& topology, In<Index> outer_loop) {
  std::vector<Index> loops;
  for (Index l = 0; l < topology.num_loops(); ++l) {
    const Index component = topology.triangle_component[topology.loop_corner[topology.loop_begin[l]] / 3];
    if (outer_loop[component] != l) loops.push_back(l);
  }
  return loops;
}

Error about_loops(ErrorCode code, const std::string& what, const Surface& surface, const Topology& topology,
                  In<Index> loops, In<Index> vertex_origin) {
  Error error{.code = code, .what = what, .element = ElementKind::Vertex};
  for (const Index l : loops) {
    for (const Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(l))) {
      ++error.count;
      if (error.ids.size() < kMaxListedIds) error.ids.push_back(vertex_origin[surface.corner_vertex[c]]);
    }
  }
  return error;
}

}  // namespace

#ifndef PLANISH_WITH_CGAL_GPL
HolePatches patch_holes(const Surface&, const Topology&, In<Index> loops) {
  return {.position = {}, .corner_vertex = {}, .unfilled = {loops.begin(), loops.end()}};
}
constexpr ErrorCode kUnfilled = ErrorCode::NotBuilt;
constexpr const char* kWhy =
    "holes are closed before angles are solved for, and this planish was built without that "
    "(PLANISH_WITH_CGAL_GPL)";
#else
constexpr ErrorCode kUnfilled = ErrorCode::NoConvergence;
constexpr const char* kWhy = "holes are closed before angles are solved for, and no triangles close this one";
#endif

Result<FilledSurface> fill_holes(const Exec& exec, const Surface& surface, const Topology& topology,
                                 In<RestFrame> frame, In<Index> outer_loop, In<Index> vertex_origin) {
  FilledSurface filled;
  filled.corner_vertex.assign(surface.corner_vertex.begin(), surface.corner_vertex.end());
  filled.frame.assign(frame.begin(), frame.end());
  filled.num_vertices = filled.own_vertices = surface.num_vertices();
  filled.own_triangles = surface.num_triangles();
  const std::vector<Index> loops = loops_to_close(topology, outer_loop);
  if (loops.empty()) {
    filled.topology = topology;
    return filled;
  }
  HolePatches patches = patch_holes(surface, topology, loops);
  if (!patches.unfilled.empty())
    return fail(about_loops(kUnfilled, kWhy, surface, topology, patches.unfilled, vertex_origin));
  std::vector<Vec3> position(surface.position.begin(), surface.position.end());
  position.insert(position.end(), patches.position.begin(), patches.position.end());
  filled.corner_vertex.insert(filled.corner_vertex.end(), patches.corner_vertex.begin(),
                              patches.corner_vertex.end());
  filled.num_vertices = static_cast<Index>(position.size());
  const Surface closed{position, filled.corner_vertex};
  filled.topology = build_topology(exec, closed);
  filled.frame.resize(closed.num_triangles());
  rest_frames({filled.own_triangles, closed.num_triangles()}, position, filled.corner_vertex, filled.frame);
  return filled;
}

}  // namespace planish
