// The part of a constraint system that takes directions and places from a given map.
#include <algorithm>

#include "engine/constraints/map_fit.hpp"
#include "engine/constraints/pinned_triangles.hpp"
#include "engine/constraints/system.hpp"
#include "kernels/intrinsic/transport.hpp"

namespace planish {

/// Of templates that may lie either way round, the way that fits the map better.
void ConstraintSystem::choose_sides_at(In<Vec2> uv) {
  for (Index b = 0; b < static_cast<Index>(compiled_.bodies.size()); ++b) {
    const Body& body = compiled_.bodies[b];
    if (!body.chirality_open) continue;
    std::vector<Vec2> other = body.shape;
    for (Vec2& t : other) t = conjugate(t);
    if (!(misfit(body, other, uv) < misfit(body, body.shape, uv))) continue;
    if (auto turned = mirror(b); !turned) (void)mirror(b);  // others need it as it was
  }
}

Result<std::vector<double>> ConstraintSystem::orient_at(In<Vec2> uv) {
  if (!orientation_.parted.empty()) {  // joints given up for another map
    if (auto settled = settle(); !settled) return fail(settled.error());
  }
  choose_sides_at(uv);
  std::vector<BodyFit> fit = fit_bodies(compiled_, uv);
  Measured measured{.angle = {}, .frame = {}, .num_frames = rest_.topology->num_components};
  for (std::size_t b = 0; b < fit.size(); ++b) {
    measured.angle.push_back(argument(fit[b].factor));
    measured.frame.push_back(vertex_component_[compiled_.bodies[b].vertex.front()]);
  }
  auto oriented = choose_branches(compiled_, view_, measured);
  if (!oriented) return fail(oriented.error());
  orientation_ = {};
  orientation_.clusters = std::move(oriented->clusters);
  orientation_.chosen = std::move(oriented->chosen);
  std::vector<Index> members(oriented->directed_set.size(), 0);
  for (const Index set : oriented->frame_set) ++members[set];
  for (const Index set : oriented->frame_set)
    orientation_.directed.push_back(oriented->directed_set[set] || members[set] > 1);
  for (std::size_t b = 0; b < fit.size(); ++b)
    orientation_.angle.push_back(measured.angle[b] + oriented->frame_turn[measured.frame[b]]);

  // Undirected lines: a component is turned by a right angle at most.
  std::vector<double> by = std::move(oriented->frame_turn), half(by.size(), 0);
  for (Index k = 0; k < static_cast<Index>(by.size()); ++k) {
    by[k] = reduce_angle(by[k]);
    if (!orientation_.directed[k] || std::abs(by[k]) <= 0.5 * kPi || !half_turn_is_free(k)) continue;
    half[k] = kPi;
    by[k] = reduce_angle(by[k] + kPi);
  }
  turn(half);
  for (std::size_t b = 0; b < fit.size(); ++b) {
    const Vec2 turned = unit(by[measured.frame[b]]);
    fit[b].factor = multiply(turned, fit[b].factor);
    fit[b].centroid = multiply(turned, fit[b].centroid);
  }
  auto parted = nearly_closed_at(fit);
  if (!parted) return fail(parted.error());
  orientation_.parted = std::move(*parted);
  part_joints();
  return by;
}

/// Joints of cycles that close but for a part of `agreement`, whatever pins hold.
Result<std::vector<PartedJoint>> ConstraintSystem::nearly_closed_at(In<BodyFit> fit) const {
  Compiled free = compiled_;
  free.pins.clear();
  auto agreement = agree(free, view_, *rest_.mesh);
  if (!agreement) return fail(agreement.error());
  const Assemblies assemblies = find_assemblies(free, *agreement);
  std::vector<Owner> owners = find_owners(free, *agreement);
  const auto poses = [&] {
    auto start =
        std::make_unique<Poses>(free, *agreement, assemblies, orientation_.clusters, orientation_.angle);
    start->begin_at(fit);
    return start;
  };
  return part_nearly_closed(free, view_.set->agreement, poses, *agreement, owners);
}

Result<std::unique_ptr<Poses>> ConstraintSystem::poses_at(In<Vec2> uv) const {
  auto poses = closed_poses(compiled_, view_, *rest_.mesh, agreement_, assemblies_, orientation_.clusters,
                            orientation_.angle, fit_bodies(compiled_, uv));
  if (!poses) return fail(poses.error());
  (*poses)->set_base();
  if (!compiled_.pins.empty()) {
    auto checked = check_pinned_triangles(rest_, view_, compiled_, owners_, assemblies_, **poses);
    if (!checked) return fail(checked.error());
  }
  std::vector<Vec2> point(uv.size());
  for (const Owner& owner : owners_) point[owner.vertex] = (*poses)->point(owner.body, owner.place);
  auto folds = check_folds(rest_, view_, compiled_, agreement_, owners_, point);
  if (!folds) return fail(folds.error());
  return poses;
}

}  // namespace planish
