#include "engine/constraints/closure.hpp"

#include <algorithm>

#include "engine/constraints/branches.hpp"
#include "engine/constraints/owners.hpp"
#include "engine/constraints/vertex_bodies.hpp"
#include "engine/features/feature_error.hpp"

namespace planish {
namespace {

bool runs_backwards(const Poses& poses) {
  bool any = false;
  poses.visit_line_edges([&](double length, double, Index, Index) { any |= !(length > 0); });
  return any;
}

bool is_collapsed(const Poses& poses) {
  const Index least = poses.smallest();
  return least != kNone && poses.scale(least) < kLeastScale;
}

/// Whether some of the constraints alone have no poses.
bool has_no_poses(const Restricted& part, const ConstraintView& view, const OrderedMesh& mesh,
                  In<double> angle) {
  Measured measured{.angle = {}, .frame = {}, .num_frames = 1};
  for (std::size_t b = 0; b < part.body.size(); ++b) {
    if (part.body[b] != kNone) measured.angle.push_back(angle[b]);
  }
  measured.frame.assign(measured.angle.size(), 0);
  const auto agreed = agree(part.compiled, view, mesh);
  if (!agreed) return true;
  const auto oriented = choose_branches(part.compiled, view, measured);
  if (!oriented) return true;
  const Assemblies assemblies = find_assemblies(part.compiled, *agreed);
  Poses poses(part.compiled, *agreed, assemblies, oriented->clusters, measured.angle);
  return poses.close().has_value() || is_collapsed(poses);
}

/// Constraints of the bodies that hang together with one, and of the pins that hold them.
std::vector<Index> constraints_around(Index body, const Compiled& compiled, const Assemblies& assemblies) {
  std::vector<Index> found;
  for (std::size_t b = 0; b < compiled.bodies.size(); ++b) {
    const bool same_group = !compiled.bodies[body].scale_group.empty() &&
                            compiled.bodies[b].scale_group == compiled.bodies[body].scale_group;
    if (same_group || assemblies.of[b] == assemblies.of[body]) found.push_back(compiled.bodies[b].constraint);
  }
  const VertexBodies bodies(compiled.bodies);
  for (const Pin& pin : compiled.pins) {
    for (const auto& at : bodies.of(pin.vertex)) {
      if (assemblies.of[at.body] == assemblies.of[body]) found.push_back(pin.constraint);
    }
  }
  return found;
}

/// With the relations that speak of their bodies.
std::vector<Index> with_relations(const std::vector<Index>& constraints, const Compiled& compiled) {
  std::vector<Index> found = constraints;
  const auto is_in = [&](Index b) {
    return b != kNone && std::find(constraints.begin(), constraints.end(), compiled.bodies[b].constraint) !=
                             constraints.end();
  };
  for (const Relation& r : compiled.relations) {
    if (is_in(r.a) || is_in(r.b)) found.push_back(r.constraint);
  }
  return found;
}

}  // namespace

Result<std::unique_ptr<Poses>> closed_poses(const Compiled& compiled, const ConstraintView& view,
                                            const OrderedMesh& mesh, const Agreement& agreement,
                                            const Assemblies& assemblies, const Clusters& clusters,
                                            In<double> angle, In<BodyFit> fit) {
  auto poses = std::make_unique<Poses>(compiled, agreement, assemblies, clusters, angle);
  if (!fit.empty()) poses->begin_at(fit);
  const auto gap = poses->close();
  if (!gap && !is_collapsed(*poses)) {
    if (fit.empty() || runs_backwards(*poses)) poses->spread_along_lines();
    return poses;
  }
  const std::vector<Index> involved = with_relations(
      gap ? gap->constraints : constraints_around(poses->smallest(), compiled, assemblies), compiled);
  const auto fails = [&](const std::vector<std::uint8_t>& keep) {
    return has_no_poses(restrict_to(compiled, keep), view, mesh, angle);
  };
  const std::string what = gap ? "where they meet a gap of " + in_words(gap->size * mesh.unit) +
                                     " remains, whatever their positions, directions and free scales"
                               : "they leave the free scales among them no size above 0.001";
  return fail(conflict(*view.set, smallest_failing(involved, view.set->constraints.size(), fails), what));
}

}  // namespace planish
