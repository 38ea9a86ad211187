#include "engine/constraints/system.hpp"

#include <algorithm>

#include "engine/constraints/pinned_triangles.hpp"
#include "engine/features/one_ring.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {

Result<std::unique_ptr<ConstraintSystem>> ConstraintSystem::make(const RestSurface& rest,
                                                                 const ConstraintView& view,
                                                                 const RegionMap& map,
                                                                 In<Index> vertex_component) {
  std::unique_ptr<ConstraintSystem> system(new ConstraintSystem(rest, view, vertex_component));
  auto compiled = compile(rest, view, map);
  if (!compiled) return fail(compiled.error());
  system->compiled_ = std::move(*compiled);
  auto settled = system->any_way_round([&] { return system->settle(); });
  if (!settled) return fail(settled.error());
  return system;
}

Result<void> ConstraintSystem::any_way_round(const std::function<Result<void>()>& step) {
  const Result<void> first = step();
  for (Index b = 0; b < static_cast<Index>(compiled_.bodies.size()); ++b) {
    if (first || first.error().code != ErrorCode::ConstraintsConflict) break;
    if (!compiled_.bodies[b].chirality_open) continue;
    for (const bool turned : {true, false}) {
      const auto settled = mirror(b);
      if (turned && settled && step()) return {};
    }
  }
  return first;
}

Result<void> ConstraintSystem::settle() {
  auto agreed = agree(compiled_, view_, *rest_.mesh);
  if (!agreed) return fail(agreed.error());
  agreement_ = std::move(*agreed);
  assemblies_ = find_assemblies(compiled_, agreement_);
  owners_ = find_owners(compiled_, agreement_);
  find_nodes();
  return {};
}

void ConstraintSystem::find_nodes() {
  nodes_ =
      planish::find_nodes(compiled_, owners_, assemblies_, vertex_component_, rest_.topology->num_components);
}

Result<void> ConstraintSystem::orient(const Exec& exec, const StartInput& input, Init init) {
  return any_way_round([&] { return orient_once(exec, input, init); });
}

Result<void> ConstraintSystem::orient_once(const Exec& exec, const StartInput& input, Init init) {
  auto oriented = planish::orient(exec, rest_, view_, compiled_, input, init);
  if (!oriented) return fail(oriented.error());
  orientation_ = std::move(*oriented);
  part_joints();
  return {};
}

/// What orienting found to close only nearly. Joints that pins have replaced are not there any more.
void ConstraintSystem::part_joints() {
  for (const PartedJoint& parted : orientation_.parted)
    part(agreement_, compiled_, parted.joint, parted.mismatch);
  if (!orientation_.parted.empty()) owners_ = find_owners(compiled_, agreement_);
}

/// Whether all that gives a component its direction speaks of undirected lines against the u axis.
bool ConstraintSystem::half_turn_is_free(Index component) const {
  return std::none_of(compiled_.relations.begin(), compiled_.relations.end(), [&](const Relation& r) {
    const auto is_here = [&](Index b) {
      return b != kNone && vertex_component_[compiled_.bodies[b].vertex.front()] == component;
    };
    if (!is_here(r.a) && !is_here(r.b)) return false;
    return r.a == kNone ? r.oriented : is_here(r.a) != is_here(r.b);
  });
}

void ConstraintSystem::turn(In<double> wanted) {
  std::vector<double> by(wanted.begin(), wanted.end());
  std::vector<std::uint8_t> half(by.size(), 0);
  for (Index k = 0; k < static_cast<Index>(by.size()); ++k) {
    if (!orientation_.directed[k]) continue;
    half[k] = std::abs(reduce_angle(by[k])) > 0.5 * kPi && half_turn_is_free(k);
    by[k] = half[k] ? kPi : 0;
  }
  for (std::size_t t = 0; t < orientation_.theta.size(); ++t)
    orientation_.theta[t] += by[rest_.topology->triangle_component[t]];
  const auto component_of = [&](Index b) { return vertex_component_[compiled_.bodies[b].vertex.front()]; };
  for (Index b = 0; b < static_cast<Index>(compiled_.bodies.size()); ++b) {
    orientation_.angle[b] += by[component_of(b)];
    if (half[component_of(b)] && orientation_.clusters.directed[orientation_.clusters.of[b]])
      orientation_.clusters.offset[b] += kPi;
  }
  for (std::size_t k = 0; k < compiled_.relations.size(); ++k) {
    const Relation& r = compiled_.relations[k];
    if (r.a == kNone && half[component_of(r.b)]) orientation_.chosen[k] += kPi;
  }
}

Result<std::unique_ptr<ConstraintSystem>> ConstraintSystem::without_pins() const {
  std::unique_ptr<ConstraintSystem> system(new ConstraintSystem(rest_, view_, vertex_component_));
  system->compiled_ = compiled_;
  system->compiled_.pins.clear();
  if (auto settled = system->settle(); !settled) return fail(settled.error());
  system->orientation_ = orientation_;
  system->part_joints();
  return system;
}

Result<std::unique_ptr<DofMap>> ConstraintSystem::dof_map(bool frozen) const {
  auto poses = closed_poses(compiled_, view_, *rest_.mesh, agreement_, assemblies_, orientation_.clusters,
                            orientation_.angle);
  if (!poses) return fail(poses.error());
  if (!compiled_.pins.empty()) {
    (*poses)->set_base();
    auto checked = check_pinned_triangles(rest_, view_, compiled_, owners_, assemblies_, **poses);
    if (!checked) return fail(checked.error());
  }
  return dof_map(std::move(*poses), frozen);
}

std::unique_ptr<DofMap> ConstraintSystem::dof_map(std::unique_ptr<Poses> poses, bool frozen) const {
  if (frozen) {
    auto still =
        std::make_unique<Poses>(compiled_, agreement_, assemblies_, poses->frozen(), orientation_.angle);
    still->adopt(*poses);
    poses = std::move(still);
  }
  return std::make_unique<DofMap>(nodes_, owners_, assemblies_, std::move(poses));
}

std::vector<std::uint8_t> ConstraintSystem::triangles_at_features() const {
  std::vector<std::uint8_t> at(rest_.frame.size(), 0);
  for (const Body& body : compiled_.bodies) {
    for (const Index t : body.triangle) at[t] = 1;
    if (!body.has_edges()) continue;
    for (std::size_t i = 0; i < body.num_edges(); ++i) {
      const Index u = body.vertex[i], v = body.vertex[(i + 1) % body.vertex.size()];
      for (const Index c : {half_edge(rest_.surface(), *rest_.topology, u, v),
                            half_edge(rest_.surface(), *rest_.topology, v, u)}) {
        if (c != kNone) at[c / 3] = 1;
      }
    }
  }
  return at;
}

Result<void> ConstraintSystem::mirror(Index body) {
  for (Vec2& t : compiled_.bodies[body].shape) t = conjugate(t);
  compiled_.bodies[body].mirrored = !compiled_.bodies[body].mirrored;
  for (Relation& relation : compiled_.relations) {
    if (relation.a == body) relation.along_a = -relation.along_a;
    if (relation.b == body) relation.along_b = -relation.along_b;
  }
  return settle();
}

Result<bool> ConstraintSystem::move_pin(Index vertex, Vec2 uv) {
  const std::vector<Pin> before = compiled_.pins;
  bool found = false, beside = true;
  for (Pin& pin : compiled_.pins) {
    if (view_.origin_of(rest_.mesh->vertex_origin[pin.vertex]) != vertex) continue;
    pin.uv = uv;
    found = true;
    beside = beside && is_beside(pin.vertex);
  }
  if (!found) return fail(ErrorCode::BadUsage, "vertex " + std::to_string(vertex) + " has no pin");
  if (beside && orientation_.parted.empty()) {
    find_nodes();
    return false;
  }
  orientation_.parted.clear();
  if (auto settled = settle(); !settled) {
    compiled_.pins = before;
    if (auto again = settle(); !again) return fail(again.error());
    return fail(settled.error());
  }
  return true;
}

/// No feature's vertex, and every triangle around has a corner that follows.
bool ConstraintSystem::is_beside(Index vertex) const {
  // Not the owners alone: a body that pins hold altogether yields its pinned vertices.
  for (const Body& body : compiled_.bodies) {
    if (std::find(body.vertex.begin(), body.vertex.end(), vertex) != body.vertex.end()) return false;
  }
  const Topology& topology = *rest_.topology;
  const In<Index> corner_vertex = rest_.mesh->corner_vertex;
  for (const Index c : slice(In<Index>(topology.star_corner), topology.stars().group(vertex))) {
    const Index next = corner_vertex[next_corner(c)], previous = corner_vertex[previous_corner(c)];
    if (nodes_.node[next] != next && nodes_.node[previous] != previous) return false;
  }
  return true;
}

Result<void> ConstraintSystem::check_scales(const Poses& poses) const {
  const Index least = poses.smallest();
  if (least == kNone || poses.scale(least) >= kLeastScale) return {};
  return fail(constraint_error(ErrorCode::ConstraintsConflict, *view_.set, compiled_.bodies[least].constraint,
                               compiled_.bodies[least].kind == Body::Kind::Chord
                                   ? "the best map brings the ends that it measures together"
                                   : "the best map shrinks its free scale below 0.001; give it a scale"));
}

}  // namespace planish
