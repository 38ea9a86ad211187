#include "engine/prepare/order.hpp"

#include <algorithm>

#include "kernels/topology/reorder.hpp"

namespace planish {
namespace {

struct Box {
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};

  void add(Vec3 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
};

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

std::vector<std::uint8_t> referenced_vertices(const Surface& surface) {
  std::vector<std::uint8_t> used(surface.position.size(), 0);
  for (const Index v : surface.corner_vertex) used[v] = 1;
  return used;
}

Box bounding_box(const Exec& exec, const Surface& surface, In<std::uint8_t> used) {
  std::vector<Box> part(Exec::num_blocks(surface.num_vertices(), kBlock));
  exec.for_blocks(surface.num_vertices(), kBlock, [&](Index block, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      if (used[v] && is_finite(surface.position[v])) part[block].add(surface.position[v]);
    }
  });
  Box box;
  for (const Box& b : part) {
    if (b.lower.x <= b.upper.x) box.add(b.lower), box.add(b.upper);
  }
  return box.lower.x <= box.upper.x ? box : Box{{0, 0, 0}, {0, 0, 0}};
}

/// Used vertices along the Hilbert curve.
std::vector<KeyedIndex> vertices_along_curve(const Exec& exec, const Surface& surface, In<std::uint8_t> used,
                                             Vec3 lower, double extent) {
  std::vector<std::uint64_t> key(surface.position.size());
  exec.for_blocks(surface.num_vertices(), kBlock,
                  [&](Index, Range r) { hilbert_keys(r, lower, extent, surface.position, key); });
  std::vector<KeyedIndex> items;
  items.reserve(surface.position.size());
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    if (used[v]) items.push_back({key[v], v});
  }
  sort_by_key(exec, items, kHilbertKeyBits);
  return items;
}

/// Triangles by the smallest rank of their vertices.
std::vector<KeyedIndex> triangles_by_rank(const Exec& exec, const Surface& surface, In<Index> rank,
                                          Index num_ranks) {
  std::vector<KeyedIndex> items(surface.num_triangles());
  exec.for_blocks(surface.num_triangles(), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      const Index* v = &surface.corner_vertex[3 * static_cast<std::size_t>(t)];
      items[t] = {static_cast<std::uint64_t>(std::min({rank[v[0]], rank[v[1]], rank[v[2]]})), t};
    }
  });
  sort_by_key(exec, items, bits_for(num_ranks));
  return items;
}

}  // namespace

OrderedMesh order_mesh(const Exec& exec, const Surface& surface) {
  const auto used = referenced_vertices(surface);
  const Box box = bounding_box(exec, surface, used);
  OrderedMesh mesh;
  mesh.num_input_vertices = surface.num_vertices();
  const Vec3 size = box.upper - box.lower;
  const double extent = std::max({size.x, size.y, size.z});
  mesh.unit = extent > 0 ? extent : 1;
  mesh.centre = box.lower + 0.5 * size;

  const auto vertices = vertices_along_curve(exec, surface, used, box.lower, mesh.unit);
  const auto num_vertices = static_cast<Index>(vertices.size());
  mesh.position.resize(vertices.size());
  mesh.vertex_origin.resize(vertices.size());
  std::vector<Index> rank(surface.position.size(), kNone);
  exec.for_blocks(num_vertices, kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      const Index origin = vertices[v].index;
      mesh.vertex_origin[v] = origin;
      mesh.position[v] = (1 / mesh.unit) * (surface.position[origin] - mesh.centre);
      rank[origin] = v;
    }
  });

  const auto triangles = triangles_by_rank(exec, surface, rank, num_vertices);
  mesh.triangle_origin.resize(triangles.size());
  mesh.corner_vertex.resize(surface.corner_vertex.size());
  exec.for_blocks(surface.num_triangles(), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      const Index origin = mesh.triangle_origin[t] = triangles[t].index;
      for (Index i = 0; i < 3; ++i)
        mesh.corner_vertex[3 * t + i] = rank[surface.corner_vertex[3 * origin + i]];
    }
  });
  return mesh;
}

}  // namespace planish
