#include "engine/prepare/defects.hpp"

#include <algorithm>
#include <array>

#include "kernels/intrinsic/lengths.hpp"

namespace planish {
namespace {

/// Collects one kind of defect; ids of the input, ascending.
class Finding {
 public:
  Finding(ErrorCode code, ElementKind element) : code_(code), element_(element) {}

  void add(Index id) { ids_.push_back({id, kNone}); }
  void add_edge(Index a, Index b) { ids_.push_back({std::min(a, b), std::max(a, b)}); }

  void report(Diagnosis& diagnosis) {
    if (ids_.empty()) return;
    std::sort(ids_.begin(), ids_.end());
    ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
    Defect defect{.code = code_, .element = element_, .ids = {}, .count = static_cast<Offset>(ids_.size())};
    for (const auto& [a, b] : ids_) {
      if (defect.ids.size() + (b == kNone ? 1 : 2) > kMaxListedIds) break;
      defect.ids.push_back(a);
      if (b != kNone) defect.ids.push_back(b);
    }
    diagnosis.defects.push_back(std::move(defect));
  }

 private:
  ErrorCode code_;
  ElementKind element_;
  std::vector<std::array<Index, 2>> ids_;
};

void find_non_finite(const OrderedMesh& mesh, Diagnosis& diagnosis) {
  Finding finding(ErrorCode::NonFinitePosition, ElementKind::Vertex);
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    const Vec3 p = mesh.position[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) finding.add(mesh.vertex_origin[v]);
  }
  finding.report(diagnosis);
}

/// Triangles that name a vertex twice, and those too flat for the precision of the coordinates.
void find_degenerate(const OrderedMesh& mesh, Diagnosis& diagnosis) {
  const double magnitude =
      std::max({std::abs(mesh.centre.x), std::abs(mesh.centre.y), std::abs(mesh.centre.z)}) / mesh.unit + 0.5;
  const double least_altitude = 4 * std::numeric_limits<double>::epsilon() * magnitude;
  Finding repeated(ErrorCode::RepeatedVertex, ElementKind::Triangle);
  Finding degenerate(ErrorCode::DegenerateTriangle, ElementKind::Triangle);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const Index* v = &mesh.corner_vertex[3 * static_cast<std::size_t>(t)];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
      repeated.add(mesh.triangle_origin[t]);
      continue;
    }
    const Vec3 a = mesh.position[v[0]], b = mesh.position[v[1]], c = mesh.position[v[2]];
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    if (!std::isfinite(longest)) continue;  // named by vertex
    if (norm(cross(b - a, c - a)) <= least_altitude * longest) degenerate.add(mesh.triangle_origin[t]);
  }
  repeated.report(diagnosis);
  degenerate.report(diagnosis);
}

/// Copies of a triangle in any rotation or orientation; looked for at the star of its smallest vertex.
void find_duplicates(const OrderedMesh& mesh, const Topology& topology, Diagnosis& diagnosis) {
  const auto sorted_vertices = [&](Index t) {
    std::array<Index, 3> v = {mesh.corner_vertex[3 * t], mesh.corner_vertex[3 * t + 1],
                              mesh.corner_vertex[3 * t + 2]};
    std::sort(v.begin(), v.end());
    return v;
  };
  Finding finding(ErrorCode::DuplicateTriangle, ElementKind::Triangle);
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    std::vector<std::pair<std::array<Index, 3>, Index>>
        triangles;  // stars are short, or there is a fan of many
    for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
      if (topology.edge_kind[c] != EdgeKind::Interior && topology.edge_kind[c] != EdgeKind::Boundary) {
        triangles.emplace_back(sorted_vertices(c / 3), mesh.triangle_origin[c / 3]);
      }
    }
    std::sort(triangles.begin(), triangles.end());
    for (std::size_t i = 1; i < triangles.size(); ++i) {
      const bool same = triangles[i].first == triangles[i - 1].first && triangles[i].first[0] == v;
      if (same && triangles[i].second != triangles[i - 1].second) finding.add(triangles[i].second);
    }
  }
  finding.report(diagnosis);
}

void find_edges_of_kind(const OrderedMesh& mesh, const Topology& topology, EdgeKind kind, ErrorCode code,
                        Diagnosis& diagnosis) {
  Finding finding(code, ElementKind::Edge);
  for (Index c = 0; c < static_cast<Index>(topology.edge_kind.size()); ++c) {
    if (topology.edge_kind[c] != kind) continue;
    const Index a = mesh.corner_vertex[c], b = mesh.corner_vertex[next_corner(c)];
    if (a != b) finding.add_edge(mesh.vertex_origin[a], mesh.vertex_origin[b]);
  }
  finding.report(diagnosis);
}

/// Vertices whose edges are all sound and whose triangles still form more than one fan.
void find_split_stars(const OrderedMesh& mesh, const Topology& topology, Diagnosis& diagnosis) {
  const auto is_sound = [&](Index c) {
    const EdgeKind k = topology.edge_kind[c];
    return k == EdgeKind::Interior || k == EdgeKind::Boundary;
  };
  Finding finding(ErrorCode::NonManifoldVertex, ElementKind::Vertex);
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    if (topology.single_fan[v]) continue;
    const auto star = slice(In<Index>(topology.star_corner), topology.stars().group(v));
    if (std::all_of(star.begin(), star.end(),
                    [&](Index c) { return is_sound(c) && is_sound(previous_corner(c)); })) {
      finding.add(mesh.vertex_origin[v]);
    }
  }
  finding.report(diagnosis);
}

/// Components that no turning of triangles can orient: found by a walk that turns as it goes.
void find_not_orientable(const OrderedMesh& mesh, const Topology& topology, Diagnosis& diagnosis) {
  Finding finding(ErrorCode::NotOrientable, ElementKind::Triangle);
  std::vector<std::int8_t> side(mesh.num_triangles(), 0);
  std::vector<Index> stack;
  for (Index root = 0; root < mesh.num_triangles(); ++root) {
    if (side[root] != 0) continue;
    side[root] = 1;
    stack.push_back(root);
    Index first = mesh.triangle_origin[root];
    bool contradicts = false;
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      first = std::min(first, mesh.triangle_origin[t]);
      for (Index c = 3 * t; c < 3 * t + 3; ++c) {
        const Index twin = topology.corner_twin[c];
        if (twin == kNone) continue;
        const bool turned = topology.edge_kind[c] == EdgeKind::Inconsistent;
        const auto wanted = static_cast<std::int8_t>(turned ? -side[t] : side[t]);
        if (side[twin / 3] == 0) {
          side[twin / 3] = wanted;
          stack.push_back(twin / 3);
        }
        contradicts |= side[twin / 3] != wanted;
      }
    }
    if (contradicts) finding.add(first);
  }
  finding.report(diagnosis);
}

/// Euler characteristic, boundary and genus a component; only for manifolds.
void find_closed_or_with_handles(const OrderedMesh& mesh, const Topology& topology, Diagnosis& diagnosis) {
  struct Component {
    Index vertices = 0, triangles = 0, boundary_edges = 0, loops = 0, first_triangle = kNone;
  };
  std::vector<Component> components(topology.num_components);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    Component& component = components[topology.triangle_component[t]];
    const Index origin = mesh.triangle_origin[t];
    ++component.triangles;
    if (component.first_triangle == kNone || origin < component.first_triangle)
      component.first_triangle = origin;
  }
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    ++components[topology.triangle_component[topology.star_corner[topology.star_begin[v]] / 3]].vertices;
  }
  for (Index l = 0; l < topology.num_loops(); ++l) {
    const Range loop = topology.loops().group(l);
    Component& component = components[topology.triangle_component[topology.loop_corner[loop.begin] / 3]];
    ++component.loops;
    component.boundary_edges += loop.end - loop.begin;
  }
  Finding closed(ErrorCode::ClosedComponent, ElementKind::Triangle);
  Finding handles(ErrorCode::HasHandles, ElementKind::Triangle);
  for (const Component& component : components) {
    const Index edges = (3 * component.triangles + component.boundary_edges) / 2;
    const Index euler = component.vertices - edges + component.triangles;
    const Index genus = (2 - component.loops - euler) / 2;
    diagnosis.genus += genus;
    if (component.loops == 0) closed.add(component.first_triangle);
    if (genus > 0) handles.add(component.first_triangle);
  }
  closed.report(diagnosis);
  handles.report(diagnosis);
}

/// Edges counted once each, whatever meets there.
Index count_edges(const OrderedMesh& mesh, const Topology& topology) {
  Index edges = 0;
  std::vector<Index> ends;
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    ends.clear();
    for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
      for (const Index end : {mesh.corner_vertex[next_corner(c)], mesh.corner_vertex[previous_corner(c)]}) {
        if (end > v) ends.push_back(end);
      }
    }
    std::sort(ends.begin(), ends.end());
    edges += static_cast<Index>(std::unique(ends.begin(), ends.end()) - ends.begin());
  }
  return edges;
}

}  // namespace

void find_defects(const Exec&, const OrderedMesh& mesh, const Topology& topology, Diagnosis& diagnosis) {
  if (mesh.num_triangles() == 0) {
    diagnosis.defects.push_back(
        {.code = ErrorCode::NoTriangles, .element = ElementKind::None, .ids = {}, .count = 1});
    return;
  }
  diagnosis.boundary_edges = static_cast<Index>(
      std::count(topology.edge_kind.begin(), topology.edge_kind.end(), EdgeKind::Boundary));
  const Index edges = topology.manifold ? topology.num_edges : count_edges(mesh, topology);
  diagnosis.euler = mesh.num_vertices() - edges + mesh.num_triangles();
  find_non_finite(mesh, diagnosis);
  find_degenerate(mesh, diagnosis);
  if (topology.manifold) {
    find_closed_or_with_handles(mesh, topology, diagnosis);
    return;
  }
  diagnosis.genus = kNone;
  find_duplicates(mesh, topology, diagnosis);
  find_edges_of_kind(mesh, topology, EdgeKind::NonManifold, ErrorCode::NonManifoldEdge, diagnosis);
  find_split_stars(mesh, topology, diagnosis);
  find_not_orientable(mesh, topology, diagnosis);
  find_edges_of_kind(mesh, topology, EdgeKind::Inconsistent, ErrorCode::InconsistentOrientation, diagnosis);
}

}  // namespace planish
