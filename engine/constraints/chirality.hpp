// Which way round a template lies in the plane (DESIGN 3.2, chirality).
#pragma once

#include <optional>

#include "engine/constraints/body.hpp"

namespace planish {

/// Says of closed chains whether they run counter-clockwise in the plane.
class Chirality {
 public:
  explicit Chirality(const RestSurface& rest);

  /// The outer loop runs counter-clockwise with the surface on its left, a hole clockwise; any other chain has the
  /// side without the outer loop inside. None where the chain does not part the surface.
  ///   chain: vertices of a closed chain of mesh edges.   Cost: O(triangles of the smaller side).
  std::optional<bool> counter_clockwise(In<Index> chain);

 private:
  /// A flood over the triangles on one side of the chain, one step at a time.
  struct Side {
    std::vector<Index> queue;
    std::size_t head = 0;
    bool outer = false;  ///< reached an edge of the outer loop that is not of the chain
    bool exhausted() const { return head == queue.size(); }
  };
  void start(In<Index> chain);
  bool step(Side& side, Index label);
  bool is_outer_edge(Index corner) const;

  RestSurface rest_;
  std::vector<Index> label_;   ///< [T] of the flood that reached it last
  std::vector<Index> barred_;  ///< [3 T] number of the chain that the half-edge was part of last
  Index number_ = 0;           ///< of the chain; floods have the labels 2 number and 2 number + 1
  Side left_, right_;
};

/// Mean of the unit normals of the triangles beside the chain's edges, each edge weighing its length.
Vec3 mean_normal(const RestSurface& rest, In<Index> chain, bool closed);

/// Twice the signed area of a polygon.
double doubled_area(In<Vec2> polygon);

}  // namespace planish
