#include "engine/near_constraints.hpp"

#include "engine/deform/aligned_map.hpp"
#include "engine/deform/placed_features.hpp"

namespace planish {
namespace {

/// Where the map has what the DOF map holds at 0, per component: an assembly's origin, or a vertex.
std::vector<Vec2> held_places(const Workpiece& piece, const ConstraintSystem& system,
                              const PlacedFeatures& placed, In<Vec2> uv) {
  const NodeMap& nodes = system.nodes();
  std::vector<Vec2> at(piece.topology().num_components);
  std::vector<std::uint8_t> pinned(at.size(), 0);
  for (const Pin& pin : system.pins()) pinned[piece.component[pin.vertex]] = 1;
  for (const Owner& owner : system.owners()) {
    const Index assembly = system.assemblies().of[owner.body], k = piece.component[owner.vertex];
    if (!pinned[k] && nodes.assembly_node[assembly] == kNone) at[k] = placed.shift[assembly];
  }
  for (std::size_t v = 0; v < uv.size(); ++v) {
    const Index k = piece.component[v];
    if (!pinned[k] && nodes.fixed[v]) at[k] = uv[v];
  }
  return at;
}

}  // namespace

Result<NearConstraints> near_constraints(const Workpiece& piece, ConstraintSystem& system,
                                         std::vector<Vec2> uv) {
  if (auto aligned = align_map(piece, system, uv); !aligned) return fail(aligned.error());
  auto placed = place_features(system, uv);
  if (!placed) return fail(placed.error());
  if (auto scales = system.check_scales(*placed->poses); !scales) return fail(scales.error());
  NearConstraints near{.uv = std::move(uv), .place = {}, .dof = nullptr};
  const std::vector<Vec2> held = held_places(piece, system, *placed, near.uv);
  for (const Owner& owner : system.owners())
    near.place.emplace_back(owner.vertex, placed->point(system.assemblies(), owner));
  for (auto& [v, place] : near.place) place = place - held[piece.component[v]];
  for (const Pin& pin : system.pins()) near.place.emplace_back(pin.vertex, pin.uv);
  for (std::size_t v = 0; v < near.uv.size(); ++v) near.uv[v] = near.uv[v] - held[piece.component[v]];
  near.dof = system.dof_map(std::move(placed->poses), false);
  return near;
}

}  // namespace planish
