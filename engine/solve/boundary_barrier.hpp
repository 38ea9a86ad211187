// Keeps the boundary of a map from crossing itself: an energy between its vertices and edges where they come close.
#pragma once

#include <vector>

#include "engine/prepare/topology.hpp"
#include "engine/solve/local_phase.hpp"
#include "engine/solve/reduced_hessian.hpp"
#include "engine/verify/box_tree.hpp"
#include "kernels/local/contact.hpp"

namespace planish {

/// Of every boundary vertex and every boundary edge of the same component at a distance d below their reach, unless one
/// triangle has both or all three vertices are held: weight reach^2 (1 - y)^3 / y, y = d / reach. Infinite where they touch. The reach is a share of the
/// shortest edge around at rest: what lies that near across the surface is squeezed as hard as flips are resisted.
/// Ref: Li et al. 2020, Incremental Potential Contact (its distances and step bounds, with the barrier of this house).
class BoundaryBarrier {
 public:
  BoundaryBarrier(const Exec& exec, const ArapEnergy& mesh, const Topology& topology,
                  In<Index> vertex_component);
  /// The same for a part of the map, where edges with both ends in it are all that others meet.
  ///   vertex: of the whole, those of the part in its order;  part: outlives this
  BoundaryBarrier(const BoundaryBarrier& whole, const ArapEnergy& part, In<Index> vertex);

  /// The energy at uv [V]; half its gradient is added to force [V], but at fixed vertices.
  double add_forces(In<Vec2> uv, Out<Vec2> force) const;
  /// Half the Hessian, pair by pair.   projection: as in reduced_hessian()
  std::vector<HessianElement> hessian(In<Vec2> uv, double projection) const;
  /// The vertices of all pairs within a margin of their reach: those that pairs are made of for some steps to come. Ascending.
  std::vector<std::array<Index, 3>> near(In<Vec2> uv) const;
  /// The least t in (0, most] at which a vertex reaches an edge on the way uv + t direction; kInfinity where none does.
  /// Cost: O(B log B) in the boundary edges, and those whose ways meet.
  double first_contact(In<Vec2> uv, In<Vec2> direction, double most) const;

  /// No vertex reaches an edge on the straight ways from one map to another.
  bool is_clear_way(In<Vec2> from, In<Vec2> to) const;

 private:
  struct Pair {
    Index vertex, edge;
    double reach;
    SegmentDistance at;
  };
  /// At less than so many reaches.
  std::vector<Pair> pairs_within(double reaches, In<Vec2> uv) const;
  std::array<Index, 3> corners(const Pair& pair) const {
    return {tail_[pair.vertex], tail_[pair.edge], head_[pair.edge]};
  }
  template <class Visit>
  void visit_candidates(In<Box2> vertex_box, In<Box2> edge_box, Visit visit) const;

  const Exec& exec_;
  In<std::uint8_t> fixed_;
  std::vector<Index> tail_, head_;  // of boundary edge k, the surface on its left
  std::vector<Index> apex_;         // the third vertex of its triangle, kNone where it is not in the part
  std::vector<Index> component_;
  std::vector<double> reach_, edge_reach_;  // of its tail, and of both ends
};

}  // namespace planish
