#include "app/provenance.hpp"

#include <array>

namespace planish {
namespace {

/// Every used vertex at a corner of its first triangle, so that the columns are complete.
void locate_vertices(const Surface& surface, Provenance& provenance) {
  constexpr std::array<Vec3, 3> kCorner = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  provenance.vertex_origin_triangle.assign(surface.num_vertices(), kNone);
  provenance.vertex_barycentric.assign(surface.num_vertices(), {});
  for (auto c = static_cast<Index>(surface.corner_vertex.size()); c-- > 0;) {
    const Index v = surface.corner_vertex[c];
    provenance.vertex_origin_triangle[v] = c / 3;
    provenance.vertex_barycentric[v] = kCorner[c % 3];
  }
}

double coordinate(Vec3 b, Index i) { return i == 0 ? b.x : i == 1 ? b.y : b.z; }

/// From the mended mesh to the one that was read: mending turns triangles around and merges or splits vertices, but
/// leaves every corner where it was, so corners are known by their places. Vertices of triangles that changed their
/// shape keep no place.
void pass_through_repair(const Input& input, Provenance& provenance) {
  for (std::size_t v = 0; v < provenance.vertex_barycentric.size(); ++v) {
    const Index mended = provenance.vertex_origin_triangle[v];
    if (mended == kNone) continue;
    const Index original = input.triangle_origin[mended];
    std::array<double, 3> b = {};
    double found = 0;
    for (Index i = 0; i < 3; ++i) {
      const Vec3 place = input.mesh.position[input.mesh.corner_vertex[3 * mended + i]];
      for (Index j = 0; j < 3; ++j) {
        if (input.original.position[input.original.corner_vertex[3 * original + j]] != place) continue;
        b[j] += coordinate(provenance.vertex_barycentric[v], i);
        found += coordinate(provenance.vertex_barycentric[v], i);
        break;
      }
    }
    constexpr double kRounding = 1e-12;
    const bool complete = found > 1 - kRounding;
    provenance.vertex_origin_triangle[v] = complete ? original : kNone;
    provenance.vertex_barycentric[v] = complete ? Vec3{b[0], b[1], b[2]} : Vec3{};
  }
  for (Index& t : provenance.triangle_origin) t = input.triangle_origin[t];
}

}  // namespace

Provenance provenance_of(const Input& input, const Embedding* embedding) {
  Provenance provenance;
  const bool mended = !input.triangle_origin.empty();
  if (!mended && !embedding) return provenance;
  locate_vertices(input.mesh.surface(), provenance);
  if (embedding) {
    provenance.triangle_origin = embedding->triangle_origin;
    for (const SurfacePoint& origin : embedding->vertex_origin) {
      provenance.vertex_origin_triangle.push_back(origin.triangle);
      provenance.vertex_barycentric.push_back(origin.barycentric);
    }
  } else {
    for (Index t = 0; t < input.mesh.num_triangles(); ++t) provenance.triangle_origin.push_back(t);
  }
  if (mended) pass_through_repair(input, provenance);
  return provenance;
}

}  // namespace planish
