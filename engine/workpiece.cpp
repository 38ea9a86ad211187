#include "engine/workpiece.hpp"

namespace planish {

Result<Workpiece> make_workpiece(const Exec& exec, const Surface& surface) {
  auto prepared = prepare(exec, surface);
  if (!prepared) return fail(prepared.error());
  if (!prepared->diagnosis.usable()) return fail(refusal(prepared->diagnosis));
  Workpiece piece;
  piece.prepared = std::move(*prepared);
  piece.geometry = measure_geometry(exec, piece.prepared);
  piece.component = vertex_components(piece.topology(), piece.mesh().num_vertices());
  return piece;
}

void Workpiece::find_loops() {
  loop_of.assign(mesh().num_vertices(), kNone);
  for (Index l = 0; l < topology().num_loops(); ++l) {
    for (const Index c : slice(In<Index>(topology().loop_corner), topology().loops().group(l)))
      loop_of[mesh().corner_vertex[c]] = l;
  }
}

StartInput Workpiece::start_input() const {
  return {.corner_vertex = mesh().corner_vertex,
          .topology = &topology(),
          .frame = geometry.frame,
          .cotangent = geometry.cotangent,
          .angle_sum = geometry.angle_sum,
          .order = order,
          .outer_loop = outer_loop};
}

SymmetricMatrix Workpiece::laplacian_over(const Exec& exec, const NodeMap& nodes) const {
  return quotient_laplacian(exec, mesh().corner_vertex, topology(), nodes.node, nodes.num_nodes,
                            [&](Index c) { return edge_weight(c); });
}

SymmetricMatrix Workpiece::whole_laplacian(const Exec& exec) const {
  const std::vector<std::uint8_t> none(mesh().num_vertices(), 0);
  return vertex_laplacian(exec, mesh().corner_vertex, topology(), none,
                          [&](Index c) { return edge_weight(c); });
}

SymmetricMatrix Workpiece::held_laplacian(const Exec& exec, In<std::uint8_t> held) const {
  return planish::held_laplacian(exec, mesh().corner_vertex, topology(), held,
                                 [&](Index c) { return edge_weight(c); });
}

Result<GlobalPhase> Workpiece::factor(const Exec& exec, const SymmetricMatrix& laplacian) const {
  return GlobalPhase::factor(exec, laplacian, order);
}

ArapEnergy Workpiece::energy(In<std::uint8_t> fixed) const {
  return {.corner_vertex = mesh().corner_vertex,
          .stars = topology().stars(),
          .star_corner = topology().star_corner,
          .frame = geometry.frame,
          .cotangent = geometry.cotangent,
          .fixed = fixed,
          .area = geometry.area};
}

ArapProblem Workpiece::problem(GlobalPhase& global, const NodeMap& nodes, DofMap& first, DofMap& dof,
                               In<Vec2> rotation) const {
  return {.energy = energy(nodes.fixed),
          .global = &global,
          .topology = &topology(),
          .edge_weight = [this](Index c) { return edge_weight(c); },
          .first = &first,
          .dof = &dof,
          .rotation = rotation,
          .order = order,
          .vertex_component = component,
          .num_components = topology().num_components,
          .constrained = dof.poses() != nullptr};
}

}  // namespace planish
