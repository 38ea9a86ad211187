#include "engine/verify/box_tree.hpp"

#include <algorithm>

namespace planish {
namespace {

std::uint64_t spread_bits(std::uint64_t x) {  // 16 bits to every second place
  x = (x | x << 8) & 0x00FF00FF;
  x = (x | x << 4) & 0x0F0F0F0F;
  x = (x | x << 2) & 0x33333333;
  return (x | x << 1) & 0x55555555;
}

std::vector<Index> morton_order(const Exec& exec, In<Box2> box) {
  Box2 all;
  for (const Box2& b : box) all.add(b);
  const Vec2 size = all.upper - all.lower;
  const double extent = std::max(size.x, size.y);
  const double scale = extent > 0 ? 65535 / (2 * extent) : 0;
  std::vector<KeyedIndex> items(box.size());
  exec.for_blocks(static_cast<Index>(items.size()), kBlock, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) {
      const Vec2 twice = (box[i].lower - all.lower) + (box[i].upper - all.lower);
      const auto x = static_cast<std::uint64_t>(scale * twice.x),
                 y = static_cast<std::uint64_t>(scale * twice.y);
      items[i] = {spread_bits(x) | spread_bits(y) << 1, i};
    }
  });
  sort_by_key(exec, items, 32);
  std::vector<Index> order(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) order[i] = items[i].index;
  return order;
}

}  // namespace

BoxTree::BoxTree(const Exec& exec, In<Box2> box) : order_(morton_order(exec, box)) {
  num_leaves_ = Exec::num_blocks(static_cast<Index>(box.size()), kLeafSize);
  first_leaf_ =
      static_cast<Index>(std::bit_ceil(static_cast<std::uint32_t>(std::max<Index>(1, num_leaves_))));
  nodes_.resize(2 * static_cast<std::size_t>(first_leaf_));
  exec.for_blocks(num_leaves_, kBlock, [&](Index, Range r) {
    for (Index l = r.begin; l < r.end; ++l) {
      const Range places = leaf(l);
      for (Index i = places.begin; i < places.end; ++i) nodes_[first_leaf_ + l].add(box[order_[i]]);
    }
  });
  for (Index node = first_leaf_ - 1; node > 0; --node) {
    nodes_[node].add(nodes_[2 * node]);
    nodes_[node].add(nodes_[2 * node + 1]);
  }
}

}  // namespace planish
