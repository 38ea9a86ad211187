#include "engine/constraints/dof_map.hpp"

#include <algorithm>

namespace planish {
namespace {

using FieldEntry = DofMap::Motion;  // of the border's field, or of the Laplacian's image of it

bool by_column(const FieldEntry& a, const FieldEntry& b) {
  return a.column != b.column ? a.column < b.column : a.vertex < b.vertex;
}

/// Sorts, and adds up entries of one place in the order they came.
void merge(std::vector<FieldEntry>& entries) {
  std::stable_sort(entries.begin(), entries.end(), by_column);
  std::size_t last = 0;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (entries[i].column == entries[last].column && entries[i].vertex == entries[last].vertex) {
      entries[last].value += entries[i].value;
    } else {
      entries[++last] = entries[i];
    }
  }
  if (!entries.empty()) entries.resize(last + 1);
}

}  // namespace

NodeMap find_nodes(In<Index> vertex_component, Index num_components) {
  return find_nodes({}, {}, {}, vertex_component, num_components);
}

NodeMap find_nodes(const Compiled& compiled, const std::vector<Owner>& owners, const Assemblies& assemblies,
                   In<Index> vertex_component, Index num_components) {
  const auto num_vertices = static_cast<Index>(vertex_component.size());
  NodeMap map;
  map.num_nodes = num_vertices;
  map.fixed.assign(num_vertices, 0);
  std::vector<Index> assembly(num_vertices, kNone);
  for (const Owner& owner : owners) assembly[owner.vertex] = assemblies.of[owner.body];
  std::vector<std::uint8_t> settled(num_components, 0);  // components that need nothing held
  for (const Pin& pin : compiled.pins) {
    settled[vertex_component[pin.vertex]] = 1;
    if (assembly[pin.vertex] != kNone) continue;
    map.fixed[pin.vertex] = 1;
    map.place.emplace_back(pin.vertex, pin.uv);
  }
  std::vector<std::uint8_t> held = assemblies.pinned;
  for (Index v = 0; v < num_vertices; ++v) {
    std::uint8_t& has = settled[vertex_component[v]];
    if (has) continue;
    has = 1;
    if (assembly[v] == kNone) {
      map.fixed[v] = 1;
    } else {
      held[assembly[v]] = 1;
    }
  }
  map.assembly_node.assign(assemblies.size(), kNone);
  for (Index a = 0; a < assemblies.size(); ++a) {
    if (!held[a]) map.assembly_node[a] = map.num_nodes++;
  }
  map.node.resize(num_vertices);
  for (Index v = 0; v < num_vertices; ++v)
    map.node[v] = map.fixed[v] ? kNone : assembly[v] == kNone ? v : map.assembly_node[assembly[v]];
  return map;
}

DofMap::DofMap(const NodeMap& nodes, const std::vector<Owner>& owners, const Assemblies& assemblies,
               std::unique_ptr<Poses> poses)
    : nodes_(&nodes), owners_(&owners), assemblies_(&assemblies), poses_(std::move(poses)) {
  poses_->set_base();
}

std::vector<Vec2> DofMap::origin() const {
  std::vector<Vec2> x(size());
  for (const auto& [v, z] : nodes_->place) x[v] = z;
  return x;
}

bool DofMap::expand(Out<Vec2> x) {
  if (!poses_) return true;
  std::vector<double> free(num_border());
  for (Index k = 0; k < num_border(); ++k) free[k] = x[num_nodes() + k].x;
  if (!poses_->move_to(free)) return false;
  for (const Owner& owner : *owners_) {
    const Index node = nodes_->assembly_node[assemblies_->of[owner.body]];
    x[owner.vertex] = (node == kNone ? Vec2{} : x[node]) + poses_->point(owner.body, owner.place);
  }
  for (const auto& [v, z] : nodes_->place) x[v] = z;
  return true;
}

void DofMap::collect(Out<Vec2> x) {
  rebase(x);
  if (!poses_) return;
  for (const Owner& owner : *owners_) {
    const Index node = nodes_->assembly_node[assemblies_->of[owner.body]];
    if (node != kNone) x[node] = x[owner.vertex] - poses_->point(owner.body, owner.place);
  }
}

void DofMap::linearise(Out<Vec2> x) const {
  for (Index v = 0; v < num_vertices(); ++v) {
    if (nodes_->fixed[v]) x[v] = {};
  }
  visit_carried([&](Index v, Index node) { x[v] = node == kNone ? Vec2{} : x[node]; });
  for (const Motion& m : motions()) x[m.vertex] += x[num_nodes() + m.column].x * m.value;
}

void DofMap::fold(Out<Vec2> force) const {
  if (!poses_) return;
  std::fill(force.begin() + num_vertices(), force.end(), Vec2{});
  std::vector<double> slot_gradient(poses_->num_slots(), 0), gradient(num_border());
  for (const Owner& owner : *owners_) {
    const Vec2 f = force[owner.vertex];
    force[owner.vertex] = {};
    if (const Index node = nodes_->assembly_node[assemblies_->of[owner.body]]; node != kNone)
      force[node] += f;
    poses_->visit_slots(owner.body, owner.place,
                        [&](Index slot, Vec2 dz) { slot_gradient[slot] += dot(dz, f); });
  }
  poses_->pull_back(slot_gradient, gradient);
  for (Index k = 0; k < num_border(); ++k) force[num_nodes() + k] = {gradient[k], 0};
}

void DofMap::rebase(Out<Vec2> x) {
  if (!poses_) return;
  poses_->set_base();
  for (Index k = 0; k < num_border(); ++k) x[num_nodes() + k] = {};
}

std::vector<DofMap::LineEdge> DofMap::line_edges() const {
  std::vector<LineEdge> edges;
  if (!poses_) return edges;
  poses_->visit_line_edges([&](double length, double rest, Index from, Index to) {
    LineEdge edge{.length = length, .rest = rest, .rate = {}};
    const auto add = [&](Index slot, double sign) {
      if (slot == kNone) return;
      poses_->visit_free(slot, [&](Index k, double value) { edge.rate.emplace_back(k, sign * value); });
    };
    add(from, -1);
    add(to, 1);
    edges.push_back(std::move(edge));
  });
  return edges;
}

Index DofMap::reversed_edges() const {
  Index reversed = 0;
  if (poses_)
    poses_->visit_line_edges([&](double length, double, Index, Index) { reversed += !(length > 0); });
  return reversed;
}

std::vector<DofMap::Motion> DofMap::motions() const {
  std::vector<Motion> field;
  if (!poses_) return field;
  for (const Owner& owner : *owners_) {
    poses_->visit_slots(owner.body, owner.place, [&](Index slot, Vec2 dz) {
      poses_->visit_free(slot, [&](Index k, double value) {
        field.push_back({k, owner.vertex, value * dz});
      });
    });
  }
  merge(field);
  return field;
}

namespace {

/// Sorts, and adds up the values of equal pairs in the order they came.
void merge(std::vector<DofMap::Curvature>& entries) {
  const auto pair = [](const DofMap::Curvature& e) { return std::pair(e.column, e.other); };
  std::stable_sort(entries.begin(), entries.end(),
                   [&](const auto& a, const auto& b) { return pair(a) < pair(b); });
  std::size_t last = 0;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (pair(entries[i]) == pair(entries[last])) {
      entries[last].value += entries[i].value;
    } else {
      entries[++last] = entries[i];
    }
  }
  if (!entries.empty()) entries.resize(last + 1);
}

}  // namespace

std::vector<DofMap::Curvature> DofMap::curvature(In<Vec2> force) const {
  std::vector<Curvature> of_slots, of_unknowns;
  if (!poses_) return of_unknowns;
  std::vector<double> slot_gradient(poses_->num_slots(), 0);
  for (const Owner& owner : *owners_) {
    const Vec2 f = force[owner.vertex];
    poses_->visit_slot_pairs(owner.body, owner.place, [&](Index a, Index b, Vec2 second) {
      of_slots.push_back({a, b, dot(second, f)});
    });
    poses_->visit_slots(owner.body, owner.place,
                        [&](Index slot, Vec2 dz) { slot_gradient[slot] += dot(dz, f); });
  }
  poses_->visit_joint_pairs(slot_gradient, [&](Index a, Index b, double value) {
    of_slots.push_back({a, b, value});
  });
  merge(of_slots);
  for (const auto& [a, b, value] : of_slots) {
    poses_->visit_free(a, [&](Index k, double by_a) {
      poses_->visit_free(b, [&](Index l, double by_b) {
        const double product = value * by_a * by_b;
        if (a != b) of_unknowns.push_back({std::max(k, l), std::min(k, l), k == l ? 2 * product : product});
        if (a == b && k >= l) of_unknowns.push_back({k, l, product});
      });
    });
  }
  merge(of_unknowns);
  return of_unknowns;
}

DofMap::Border DofMap::border(In<Index> corner_vertex, const Topology& topology,
                              const EdgeWeight& weight) const {
  const Index m = num_border();
  Border result{.column = std::vector<SparseColumn>(m),
                .corner = std::vector<double>(static_cast<std::size_t>(m) * m, 0)};
  if (m == 0) return result;
  const std::vector<FieldEntry> field = motions();
  std::vector<FieldEntry> image;  // L times the field
  for (const FieldEntry& e : field) {
    const auto edge = [&](Index neighbour, double w) {
      image.push_back({e.column, e.vertex, w * e.value});
      image.push_back({e.column, neighbour, -w * e.value});
    };
    for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(e.vertex))) {
      edge(corner_vertex[next_corner(c)], weight(c));
      const Index arriving = previous_corner(c);
      if (topology.corner_twin[arriving] == kNone) edge(corner_vertex[arriving], weight(arriving));
    }
  }
  merge(image);
  // Columns at each vertex, for the products of fields and images.
  std::vector<FieldEntry> by_vertex = field;
  std::stable_sort(by_vertex.begin(), by_vertex.end(),
                   [](const FieldEntry& a, const FieldEntry& b) { return a.vertex < b.vertex; });
  std::vector<FieldEntry> rows;
  for (const FieldEntry& e : image) {
    if (nodes_->node[e.vertex] != kNone) rows.push_back({e.column, nodes_->node[e.vertex], e.value});
    const auto [first, last] =
        std::equal_range(by_vertex.begin(), by_vertex.end(), e,
                         [](const FieldEntry& a, const FieldEntry& b) { return a.vertex < b.vertex; });
    for (auto other = first; other != last; ++other)
      result.corner[static_cast<std::size_t>(e.column) * m + other->column] += dot(other->value, e.value);
  }
  merge(rows);
  for (const FieldEntry& e : rows) {
    result.column[e.column].row.push_back(e.vertex);
    result.column[e.column].value.push_back(e.value);
  }
  return result;
}

}  // namespace planish
