#include "engine/verify/overlaps.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "kernels/exact/orient2.hpp"

namespace planish {
namespace {

struct Box {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};

  void add(Vec2 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  void add(const Box& b) {
    lower = {std::min(lower.x, b.lower.x), std::min(lower.y, b.lower.y)};
    upper = {std::max(upper.x, b.upper.x), std::max(upper.y, b.upper.y)};
  }
  /// Shared interior; touching boxes hold triangles with disjoint interiors.
  bool meets(const Box& b) const {
    return lower.x < b.upper.x && b.lower.x < upper.x && lower.y < b.upper.y && b.lower.y < upper.y;
  }
};

/// Image of a triangle, turned to run counter-clockwise.
struct Image {
  std::array<Vec2, 3> point;
  std::array<Index, 3> vertex;
  Index triangle = kNone;
  Box box;
  bool has_area = false;
};

Image image_of(Index t, In<Index> corner_vertex, In<Vec2> uv) {
  Image image;
  image.triangle = t;
  for (int i = 0; i < 3; ++i) {
    image.vertex[i] = corner_vertex[3 * t + i];
    image.point[i] = uv[image.vertex[i]];
    image.box.add(image.point[i]);
  }
  const int side = orient2(image.point[0], image.point[1], image.point[2]);
  if (side < 0) std::swap(image.point[1], image.point[2]);
  image.has_area = side != 0;
  return image;
}

bool share_vertex(const Image& a, const Image& b) {
  for (const Index i : a.vertex) {
    for (const Index j : b.vertex) {
      if (i == j) return true;
    }
  }
  return false;
}

/// Some edge of a has all of b on its outer side or on its line.
bool separated_by_edge_of(const Image& a, const Image& b) {
  for (int i = 0; i < 3; ++i) {
    const Vec2 p = a.point[i], q = a.point[(i + 1) % 3];
    if (orient2(p, q, b.point[0]) <= 0 && orient2(p, q, b.point[1]) <= 0 && orient2(p, q, b.point[2]) <= 0)
      return true;
  }
  return false;
}

/// Two convex sets have disjoint interiors exactly when an edge line of one separates them.
bool share_interior(const Image& a, const Image& b) {
  return a.has_area && b.has_area && !separated_by_edge_of(a, b) && !separated_by_edge_of(b, a);
}

/// Area of the intersection, by clipping a against the edges of b.
double common_area(const Image& a, const Image& b) {
  std::array<Vec2, 9> polygon, clipped;
  std::size_t n = 3;
  std::copy(a.point.begin(), a.point.end(), polygon.begin());
  for (int k = 0; k < 3; ++k) {
    const Vec2 origin = b.point[k], edge = b.point[(k + 1) % 3] - origin;
    std::size_t m = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 p = polygon[i], q = polygon[(i + 1) % n];
      const double dp = cross(edge, p - origin), dq = cross(edge, q - origin);
      if (dp >= 0) clipped[m++] = p;
      if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) clipped[m++] = p + (dp / (dp - dq)) * (q - p);
    }
    n = m;
    polygon = clipped;
  }
  double twice = 0;
  for (std::size_t i = 2; i < n; ++i) twice += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return 0.5 * twice;
}

/// Keeps the first pairs when there are more; sorted then.
void keep_first(std::vector<std::array<Index, 2>>& pairs, std::size_t from) {
  if (pairs.size() < from) return;
  std::sort(pairs.begin(), pairs.end());
  pairs.resize(std::min(pairs.size(), kMaxListedIds));
}

void add_pair(const Image& a, const Image& b, Overlaps& sum) {
  ++sum.pairs;
  sum.common_area += common_area(a, b);
  sum.first.push_back({std::min(a.triangle, b.triangle), std::max(a.triangle, b.triangle)});
  keep_first(sum.first, 4 * kMaxListedIds);
}

std::uint64_t spread_bits(std::uint64_t x) {  // 16 bits to every second place
  x = (x | x << 8) & 0x00FF00FF;
  x = (x | x << 4) & 0x0F0F0F0F;
  x = (x | x << 2) & 0x33333333;
  return (x | x << 1) & 0x55555555;
}

/// Complete binary tree over leaves of a few images in Morton order. Node 1 is the root, node k has children
/// 2 k and 2 k + 1, leaf l is node first_leaf + l.
class Hierarchy {
 public:
  static constexpr Index kLeafSize = 4;

  Hierarchy(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv) {
    const auto num_triangles = static_cast<Index>(corner_vertex.size() / 3);
    const std::vector<Index> order = morton_order(exec, corner_vertex, uv);
    images_.resize(num_triangles);
    exec.for_blocks(num_triangles, kBlock, [&](Index, Range r) {
      for (Index i = r.begin; i < r.end; ++i) images_[i] = image_of(order[i], corner_vertex, uv);
    });
    num_leaves_ = Exec::num_blocks(num_triangles, kLeafSize);
    first_leaf_ =
        static_cast<Index>(std::bit_ceil(static_cast<std::uint32_t>(std::max<Index>(1, num_leaves_))));
    nodes_.resize(2 * static_cast<std::size_t>(first_leaf_));
    exec.for_blocks(num_leaves_, kBlock, [&](Index, Range r) {
      for (Index leaf = r.begin; leaf < r.end; ++leaf) {
        for (const Image& image : leaf_images(leaf)) nodes_[first_leaf_ + leaf].add(image.box);
      }
    });
    for (Index node = first_leaf_ - 1; node > 0; --node) {
      nodes_[node].add(nodes_[2 * node]);
      nodes_[node].add(nodes_[2 * node + 1]);
    }
  }

  Index num_leaves() const { return num_leaves_; }

  In<Image> leaf_images(Index leaf) const {
    const Range r = Exec::block_range(static_cast<Index>(images_.size()), kLeafSize, leaf);
    return In<Image>(images_).subspan(r.begin, r.end - r.begin);
  }

  /// Calls visit(other leaf) for the leaves from `leaf` on whose boxes meet its box.
  template <class Visit>
  void for_later_meeting(Index leaf, Visit&& visit) const {
    const Box& box = nodes_[first_leaf_ + leaf];
    std::array<Index, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 1;
    while (depth > 0) {
      const Index node = stack[--depth];
      if (!nodes_[node].meets(box) || last_leaf_below(node) < leaf) continue;
      if (node >= first_leaf_) {
        visit(node - first_leaf_);
      } else {
        stack[depth++] = 2 * node + 1;
        stack[depth++] = 2 * node;
      }
    }
  }

 private:
  static std::vector<Index> morton_order(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv) {
    Box box;
    for (const Vec2 p : uv) box.add(p);
    const Vec2 size = box.upper - box.lower;
    const double extent = std::max(size.x, size.y);
    const double scale = extent > 0 ? 65535 / (3 * extent) : 0;
    std::vector<KeyedIndex> items(corner_vertex.size() / 3);
    exec.for_blocks(static_cast<Index>(items.size()), kBlock, [&](Index, Range r) {
      for (Index t = r.begin; t < r.end; ++t) {
        const Vec2 sum = (uv[corner_vertex[3 * t]] - box.lower) + (uv[corner_vertex[3 * t + 1]] - box.lower) +
                         (uv[corner_vertex[3 * t + 2]] - box.lower);
        const auto x = static_cast<std::uint64_t>(scale * sum.x),
                   y = static_cast<std::uint64_t>(scale * sum.y);
        items[t] = {spread_bits(x) | spread_bits(y) << 1, t};
      }
    });
    sort_by_key(exec, items, 32);
    std::vector<Index> order(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) order[i] = items[i].index;
    return order;
  }

  Index last_leaf_below(Index node) const {
    const int height = std::bit_width(static_cast<std::uint32_t>(first_leaf_)) -
                       std::bit_width(static_cast<std::uint32_t>(node));
    return ((node + 1) << height) - 1 - first_leaf_;
  }

  std::vector<Image> images_;
  std::vector<Box> nodes_;
  Index num_leaves_ = 0, first_leaf_ = 1;
};

}  // namespace

Overlaps find_overlaps(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv) {
  constexpr Index kLeavesPerBlock = 256;
  const Hierarchy hierarchy(exec, corner_vertex, uv);
  std::vector<Overlaps> part(Exec::num_blocks(hierarchy.num_leaves(), kLeavesPerBlock));
  exec.for_blocks(hierarchy.num_leaves(), kLeavesPerBlock, [&](Index block, Range r) {
    Overlaps& sum = part[block];
    const auto compare = [&](const Image& a, const Image& b) {
      if (a.box.meets(b.box) && !share_vertex(a, b) && share_interior(a, b)) add_pair(a, b, sum);
    };
    for (Index leaf = r.begin; leaf < r.end; ++leaf) {
      const In<Image> mine = hierarchy.leaf_images(leaf);
      for (const Image& image : mine) {
        sum.map_area += 0.5 * cross(image.point[1] - image.point[0], image.point[2] - image.point[0]);
      }
      hierarchy.for_later_meeting(leaf, [&](Index other) {
        const In<Image> theirs = hierarchy.leaf_images(other);
        for (std::size_t i = 0; i < mine.size(); ++i) {
          for (std::size_t j = other == leaf ? i + 1 : 0; j < theirs.size(); ++j) compare(mine[i], theirs[j]);
        }
      });
    }
  });
  Overlaps all;
  for (const Overlaps& p : part) {
    all.pairs += p.pairs;
    all.common_area += p.common_area;
    all.map_area += p.map_area;
    all.first.insert(all.first.end(), p.first.begin(), p.first.end());
  }
  keep_first(all.first, 0);
  return all;
}

}  // namespace planish
