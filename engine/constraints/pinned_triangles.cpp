#include "engine/constraints/pinned_triangles.hpp"

#include <algorithm>

#include "engine/constraints/vertex_bodies.hpp"
#include "engine/features/feature_error.hpp"

namespace planish {
namespace {

/// Where vertices lie that nothing can move.
class PinnedPlaces {
 public:
  PinnedPlaces(const Compiled& compiled, const std::vector<Owner>& owners, const Assemblies& assemblies,
               const Poses& poses, Index num_vertices)
      : compiled_(compiled),
        assemblies_(assemblies),
        bodies_(compiled.bodies),
        change_(poses.num_free()),
        point_(num_vertices) {
    for (const Owner& owner : owners) {
      if (assemblies.pinned[assemblies.of[owner.body]] && is_still(poses, owner))
        point_[owner.vertex] = poses.point(owner.body, owner.place);
    }
    for (const Pin& pin : compiled.pins) point_[pin.vertex] = pin.uv;
  }

  bool turned_over(const Index* corner) const {
    const std::optional<Vec2>&a = point_[corner[0]], &b = point_[corner[1]], &c = point_[corner[2]];
    return a && b && c && !(cross(*b - *a, *c - *a) > 0);
  }

  /// What gives a vertex its place.
  void add_constraints(Index vertex, std::vector<Index>& constraints) const {
    for (const auto& at : bodies_.of(vertex)) constraints.push_back(compiled_.bodies[at.body].constraint);
    for (const Pin& pin : compiled_.pins) {
      if (pin.vertex == vertex || hang_together(pin.vertex, vertex)) constraints.push_back(pin.constraint);
    }
  }

 private:
  bool hang_together(Index u, Index v) const {
    for (const auto& a : bodies_.of(u)) {
      for (const auto& b : bodies_.of(v)) {
        if (assemblies_.of[a.body] == assemblies_.of[b.body]) return true;
      }
    }
    return false;
  }

  bool is_still(const Poses& poses, const Owner& owner) {
    constexpr double kStill = 1e-9;  // units of the mesh a unit of the free coordinates
    std::vector<Index> touched;
    poses.visit_slots(owner.body, owner.place, [&](Index slot, Vec2 dz) {
      poses.visit_free(slot, [&](Index k, double value) {
        change_[k] += value * dz;
        touched.push_back(k);
      });
    });
    double most = 0;
    for (const Index k : touched) most = std::max(most, norm(change_[k]));
    for (const Index k : touched) change_[k] = {};
    return most <= kStill;
  }

  const Compiled& compiled_;
  const Assemblies& assemblies_;
  VertexBodies bodies_;
  std::vector<Vec2> change_;                // per free coordinate, all 0 but within is_still
  std::vector<std::optional<Vec2>> point_;  // per vertex
};

}  // namespace

Result<void> check_pinned_triangles(const RestSurface& rest, const ConstraintView& view,
                                    const Compiled& compiled, const std::vector<Owner>& owners,
                                    const Assemblies& assemblies, const Poses& poses) {
  const PinnedPlaces places(compiled, owners, assemblies, poses, rest.mesh->num_vertices());
  const std::vector<Index>& vertex = rest.mesh->corner_vertex;
  std::vector<Index> turned, constraints;
  for (std::size_t c = 0; c < vertex.size(); c += 3) {
    if (!places.turned_over(&vertex[c])) continue;
    turned.push_back(rest.mesh->triangle_origin[c / 3]);
    for (std::size_t i = c; i < c + 3; ++i) places.add_constraints(vertex[i], constraints);
  }
  if (turned.empty()) return {};
  Error error =
      conflict(*view.set, constraints,
               "the places that they give to all corners turn over or flatten triangles of the mesh");
  std::sort(turned.begin(), turned.end());
  OffendingIds ids;
  for (const Index t : turned) ids.add(t);
  return fail(ids.of(std::move(error), ElementKind::Triangle));
}

}  // namespace planish
