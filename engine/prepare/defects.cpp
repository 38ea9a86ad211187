#include "engine/prepare/defects.hpp"

#include <algorithm>
#include <array>

#include "engine/prepare/soup.hpp"
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

/// A box too large or too small to be scaled to the unit cube. Every coordinate is lost then, and no vertex
/// can be named.
bool find_unusable_span(const OrderedMesh& mesh, Diagnosis& diagnosis) {
  const bool too_large = !std::isfinite(mesh.unit), too_small = !std::isfinite(1 / mesh.unit);
  if (!too_large && !too_small) return false;
  diagnosis.defects.push_back(
      {.code = ErrorCode::NonFinitePosition,
       .element = ElementKind::None,
       .ids = {},
       .count = 1,
       .what = too_large ? "the coordinates of the vertices span more than doubles can hold"
                         : "the coordinates of the vertices span less than doubles can scale"});
  return true;
}

void find_non_finite(const OrderedMesh& mesh, Diagnosis& diagnosis) {
  if (find_unusable_span(mesh, diagnosis)) return;
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

/// A component by itself; sound: a manifold that can be oriented.
struct Component {
  Index vertices = 0, triangles = 0, boundary_edges = 0, loops = 0, first_triangle = kNone;
  bool sound = true, turned = false;

  Index genus() const {
    const Index edges = (3 * triangles + boundary_edges) / 2;
    const Index euler = vertices - edges + triangles;
    return (2 - loops - euler) / 2;
  }
};

/// Components that no turning of triangles can orient: found by a walk that turns as it goes. They are marked
/// unsound.
void find_not_orientable(const OrderedMesh& mesh, const Topology& topology, Out<Component> components,
                         Diagnosis& diagnosis) {
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
    if (!contradicts) continue;
    finding.add(first);
    components[topology.triangle_component[root]].sound = false;
  }
  finding.report(diagnosis);
}

std::vector<Component> components_of(const OrderedMesh& mesh, const Topology& topology) {
  std::vector<Component> components(topology.num_components);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    Component& component = components[topology.triangle_component[t]];
    const Index origin = mesh.triangle_origin[t];
    ++component.triangles;
    if (component.first_triangle == kNone || origin < component.first_triangle)
      component.first_triangle = origin;
  }
  return components;
}

/// Vertices and boundary of the components of a manifold.
void count_manifold(const OrderedMesh& mesh, const Topology& topology, Out<Component> components) {
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    ++components[topology.triangle_component[topology.star_corner[topology.star_begin[v]] / 3]].vertices;
  }
  for (Index l = 0; l < topology.num_loops(); ++l) {
    const Range loop = topology.loops().group(l);
    Component& component = components[topology.triangle_component[topology.loop_corner[loop.begin] / 3]];
    ++component.loops;
    component.boundary_edges += loop.end - loop.begin;
  }
}

/// Corners at one vertex that hang together across edges of two triangles: a fan each.
Unions fans_of(const OrderedMesh& mesh, const Topology& topology) {
  Unions fans(static_cast<Index>(mesh.corner_vertex.size()));
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    const Index twin = topology.corner_twin[c];
    if (twin == kNone || twin < c) continue;
    const bool turned = topology.edge_kind[c] == EdgeKind::Inconsistent;
    fans.unite(c, turned ? twin : next_corner(twin));
    fans.unite(next_corner(c), turned ? next_corner(twin) : twin);
  }
  return fans;
}

/// Marks the components unsound that have an edge of more than two triangles, or touch themselves in a vertex.
void mark_unsound(const OrderedMesh& mesh, const Topology& topology, Unions& fans,
                  Out<Component> components) {
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    Component& component = components[topology.triangle_component[c / 3]];
    component.sound &= topology.edge_kind[c] != EdgeKind::NonManifold;
    component.turned |= topology.edge_kind[c] == EdgeKind::Inconsistent;
  }
  std::vector<std::array<Index, 2>> at_vertex;  // component and fan
  for (Index v = 0; v < mesh.num_vertices(); ++v) {
    if (topology.single_fan[v]) continue;
    at_vertex.clear();
    for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(v))) {
      at_vertex.push_back({topology.triangle_component[c / 3], fans.root(c)});
    }
    std::sort(at_vertex.begin(), at_vertex.end());
    for (std::size_t i = 1; i < at_vertex.size(); ++i) {
      const auto [component, fan] = at_vertex[i];
      if (component == at_vertex[i - 1][0] && fan != at_vertex[i - 1][1]) components[component].sound = false;
    }
  }
}

/// Vertices and boundary of every component, as if it shared no vertex with the others: its vertices are its
/// fans, its loops the sets of boundary edges that hang together at fans. Right for sound ones only.
void count_alone(const OrderedMesh& mesh, const Topology& topology, Unions& fans, Out<Component> components) {
  const auto num_corners = static_cast<Index>(mesh.corner_vertex.size());
  Unions loops(num_corners);  // of the fans' first corners
  for (Index c = 0; c < num_corners; ++c) {
    Component& component = components[topology.triangle_component[c / 3]];
    if (fans.root(c) == c) ++component.vertices;
    if (topology.edge_kind[c] != EdgeKind::Boundary) continue;
    ++component.boundary_edges;
    // Every edge but the one that closes a loop joins two sets.
    const Index start = loops.root(fans.root(c)), end = loops.root(fans.root(next_corner(c)));
    if (start == end) ++component.loops;
    loops.unite(start, end);
  }
}

void find_closed_or_with_handles(In<Component> components, Diagnosis& diagnosis) {
  Finding closed(ErrorCode::ClosedComponent, ElementKind::Triangle);
  Finding handles(ErrorCode::HasHandles, ElementKind::Triangle);
  for (const Component& component : components) {
    const bool doubled = component.triangles == 2 && component.turned;  // listed twice: named as a copy
    if (!component.sound || (doubled && component.loops == 0)) continue;
    if (component.loops == 0) closed.add(component.first_triangle);
    if (component.genus() > 0) handles.add(component.first_triangle);
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
  std::vector<Component> components = components_of(mesh, topology);
  if (topology.manifold) {
    count_manifold(mesh, topology, components);
    for (const Component& component : components) diagnosis.genus += component.genus();
    find_closed_or_with_handles(components, diagnosis);
    return;
  }
  diagnosis.genus = kNone;
  find_duplicates(mesh, topology, diagnosis);
  find_edges_of_kind(mesh, topology, EdgeKind::NonManifold, ErrorCode::NonManifoldEdge, diagnosis);
  find_split_stars(mesh, topology, diagnosis);
  find_not_orientable(mesh, topology, components, diagnosis);
  find_edges_of_kind(mesh, topology, EdgeKind::Inconsistent, ErrorCode::InconsistentOrientation, diagnosis);
  Unions fans = fans_of(mesh, topology);
  mark_unsound(mesh, topology, fans, components);
  count_alone(mesh, topology, fans, components);
  find_closed_or_with_handles(components, diagnosis);
}

}  // namespace planish
