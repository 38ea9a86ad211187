#include "engine/verify/flat_surface.hpp"

#include "engine/prepare/cut.hpp"

namespace planish {
namespace {

/// The surface without its unreferenced vertices, which have no star.
struct UsedPart {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex, origin;
  Surface surface() const { return {position, corner_vertex}; }
};

UsedPart used_part(const Surface& surface) {
  std::vector<Index> number(surface.position.size(), kNone);
  for (const Index v : surface.corner_vertex) number[v] = 0;
  UsedPart part;
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = static_cast<Index>(part.origin.size());
    part.origin.push_back(v);
    part.position.push_back(surface.position[v]);
  }
  for (const Index v : surface.corner_vertex) part.corner_vertex.push_back(number[v]);
  return part;
}

}  // namespace

FlatSurface open_where_torn(const Exec& exec, const Surface& surface, In<Vec2> corner_uv) {
  const UsedPart part = used_part(surface);
  const Topology whole = build_topology(exec, part.surface());
  const std::vector<Index> torn = torn_half_edges(whole.corner_twin, corner_uv);
  CutSurface opened = open_along(exec, part.surface(), whole, torn);
  FlatSurface flat;
  flat.torn_edges = static_cast<Index>(torn.size());
  flat.position = std::move(opened.position);
  flat.corner_vertex = std::move(opened.corner_vertex);
  for (const Index v : opened.vertex_origin) flat.origin.push_back(part.origin[v]);
  flat.uv.resize(flat.position.size());
  for (std::size_t c = 0; c < corner_uv.size(); ++c) flat.uv[flat.corner_vertex[c]] = corner_uv[c];
  flat.topology = build_topology(exec, flat.surface());
  return flat;
}

}  // namespace planish
