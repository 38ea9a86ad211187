#include "engine/prepare/cut_graph.hpp"

#include <algorithm>

#include "engine/prepare/component_cut.hpp"

namespace planish {
namespace {

/// Items of each group in ascending order, as compressed rows.
struct Groups {
  std::vector<Index> begin, item;
  In<Index> group(Index g) const { return slice(In<Index>(item), Offsets{begin}.group(g)); }
};

/// group_of(i) in [0, num_groups), or kNone for none.
template <class GroupOf>
Groups group_items(Index num_items, Index num_groups, GroupOf&& group_of) {
  std::vector<Index> counts(num_groups, 0);
  for (Index i = 0; i < num_items; ++i) {
    if (const Index g = group_of(i); g != kNone) ++counts[g];
  }
  Groups groups{exclusive_scan(counts), {}};
  groups.item.resize(groups.begin.back());
  std::vector<Index> place(groups.begin.begin(), groups.begin.end() - 1);
  for (Index i = 0; i < num_items; ++i) {
    if (const Index g = group_of(i); g != kNone) groups.item[place[g]++] = i;
  }
  return groups;
}

/// The sharp edges by the angle between the triangles' normals; triangles without area are not bent.
void price_edges(const Exec& exec, const Surface& surface, const Topology& topology,
                 In<Index> preferred_corner, const CutGraphOptions& options, CutColumns& columns) {
  const Index num_triangles = surface.num_triangles();
  const auto& twin = topology.corner_twin;
  const auto point = [&](Index c) { return surface.position[surface.corner_vertex[c]]; };
  std::vector<Vec3> normal(num_triangles);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      normal[t] = cross(point(3 * t + 1) - point(3 * t), point(3 * t + 2) - point(3 * t));
    }
  });
  columns.length.resize(3 * static_cast<std::size_t>(num_triangles));
  columns.cost.resize(columns.length.size());
  const double cosine = std::cos(options.sharp_degrees * kPi / 180);
  exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
    for (Index c = 3 * r.begin; c < 3 * r.end; ++c) {
      columns.cost[c] = columns.length[c] = norm(point(next_corner(c)) - point(c));
      if (twin[c] == kNone) continue;
      const Vec3 a = normal[c / 3], b = normal[twin[c] / 3];
      if (dot(a, b) < cosine * norm(a) * norm(b)) columns.cost[c] *= options.sharp_discount;
    }
  });
  for (Index p : preferred_corner) {
    for (Index c : {p, twin[p]}) {
      if (c != kNone) columns.cost[c] = columns.length[c] * options.sharp_discount;
    }
  }
}

CutColumns make_columns(const Exec& exec, const Surface& surface, const Topology& topology,
                        In<Index> preferred_corner, const CutGraphOptions& options) {
  CutColumns columns;
  price_edges(exec, surface, topology, preferred_corner, options, columns);
  const std::size_t num_vertices = surface.position.size(), num_corners = surface.corner_vertex.size();
  columns.hole.assign(num_vertices, kNone);
  for (Index l = 0; l < topology.num_loops(); ++l) {
    for (Index c : slice(In<Index>(topology.loop_corner), topology.loops().group(l))) {
      columns.hole[surface.corner_vertex[c]] = l;
    }
  }
  columns.distance.resize(num_vertices);
  columns.nearest_root.resize(num_vertices);
  columns.arrival.resize(num_vertices);
  columns.degree.assign(num_vertices, 0);
  columns.parent.resize(num_corners / 3);
  columns.cut.assign(num_corners, 0);
  columns.side.assign(num_corners, 0);
  return columns;
}

/// Loops and genus of each component, with its triangles and vertices.
std::vector<CutComponent> find_components(const Topology& topology, const Groups& triangles,
                                          const Groups& vertices) {
  std::vector<CutComponent> components(topology.num_components);
  std::vector<Index> border(components.size(), 0);
  for (Index l = 0; l < topology.num_loops(); ++l) {
    const Range loop = topology.loops().group(l);
    const Index k = topology.triangle_component[topology.loop_corner[loop.begin] / 3];
    ++components[k].loops;
    border[k] += loop.end - loop.begin;
  }
  for (std::size_t k = 0; k < components.size(); ++k) {
    CutComponent& component = components[k];
    component.triangle = triangles.group(static_cast<Index>(k));
    component.vertex = vertices.group(static_cast<Index>(k));
    const auto faces = static_cast<Offset>(component.triangle.size());
    const Offset euler = static_cast<Offset>(component.vertex.size()) - (3 * faces + border[k]) / 2 + faces;
    component.genus = static_cast<Index>((2 - component.loops - euler) / 2);
  }
  return components;
}

}  // namespace

CutGraph find_cut_graph(const Exec& exec, const Surface& surface, const Topology& topology,
                        In<Index> preferred_corner, const CutGraphOptions& options) {
  const auto& component_of = topology.triangle_component;
  const Groups triangles =
      group_items(surface.num_triangles(), topology.num_components, [&](Index t) { return component_of[t]; });
  const Groups vertices = group_items(surface.num_vertices(), topology.num_components, [&](Index v) {
    const Range star = topology.stars().group(v);
    return star.begin == star.end ? kNone : component_of[topology.star_corner[star.begin] / 3];
  });
  std::vector<CutComponent> components = find_components(topology, triangles, vertices);
  std::erase_if(components, [](const CutComponent& component) { return !component.needs_cut(); });
  CutGraph graph;
  if (components.empty()) return graph;

  CutColumns columns = make_columns(exec, surface, topology, preferred_corner, options);
  std::vector<std::vector<Index>> edges(components.size());
  exec.for_tasks(static_cast<Index>(components.size()),
                 [&](Index k) { edges[k] = cut_component(surface, topology, components[k], columns); });
  for (const auto& part : edges) graph.corner.insert(graph.corner.end(), part.begin(), part.end());
  std::sort(graph.corner.begin(), graph.corner.end());
  std::vector<double> length;
  for (Index c : graph.corner) length.push_back(columns.length[c]);
  graph.length = pairwise_sum(length);
  return graph;
}

}  // namespace planish
