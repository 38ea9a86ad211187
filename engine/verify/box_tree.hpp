// A bounding volume hierarchy over boxes in the plane.
#pragma once

#include <array>
#include <bit>
#include <vector>

#include "engine/exec/parallel.hpp"

namespace planish {

struct Box2 {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};

  void add(Vec2 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  void add(const Box2& b) {
    lower = {std::min(lower.x, b.lower.x), std::min(lower.y, b.lower.y)};
    upper = {std::max(upper.x, b.upper.x), std::max(upper.y, b.upper.y)};
  }
  /// Shared interior.
  bool meets(const Box2& b) const {
    return lower.x < b.upper.x && b.lower.x < upper.x && lower.y < b.upper.y && b.lower.y < upper.y;
  }
  Box2 grown(double by) const { return {lower - Vec2{by, by}, upper + Vec2{by, by}}; }
};

/// Complete binary tree over leaves of a few boxes in Morton order. Node 1 is the root, node k has children 2 k and 2 k + 1,
/// leaf l is node first_leaf + l.
class BoxTree {
 public:
  static constexpr Index kLeafSize = 4;

  /// Cost: O(n log n), parallel.
  BoxTree(const Exec& exec, In<Box2> box);

  Index num_leaves() const { return num_leaves_; }
  /// Boxes in the order of the tree.
  In<Index> order() const { return order_; }
  /// Places in that order.
  Range leaf(Index l) const { return Exec::block_range(static_cast<Index>(order_.size()), kLeafSize, l); }
  const Box2& leaf_box(Index l) const { return nodes_[first_leaf_ + l]; }

  /// Calls visit(leaf) for the leaves from `first` on whose boxes meet a box, ascending.
  template <class Visit>
  void visit_meeting(const Box2& box, Index first, Visit visit) const {
    std::array<Index, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 1;
    while (depth > 0) {
      const Index node = stack[--depth];
      if (!nodes_[node].meets(box) || last_leaf_below(node) < first) continue;
      if (node >= first_leaf_) {
        visit(node - first_leaf_);
      } else {
        stack[depth++] = 2 * node + 1;
        stack[depth++] = 2 * node;
      }
    }
  }

 private:
  Index last_leaf_below(Index node) const {
    const int height = std::bit_width(static_cast<std::uint32_t>(first_leaf_)) -
                       std::bit_width(static_cast<std::uint32_t>(node));
    return ((node + 1) << height) - 1 - first_leaf_;
  }

  std::vector<Index> order_;
  std::vector<Box2> nodes_;
  Index num_leaves_ = 0, first_leaf_ = 1;
};

}  // namespace planish
