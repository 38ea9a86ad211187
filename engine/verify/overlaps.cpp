#include "engine/verify/overlaps.hpp"

#include <algorithm>
#include <array>

#include "engine/verify/box_tree.hpp"
#include "kernels/exact/orient2.hpp"

namespace planish {
namespace {

/// Image of a triangle, turned to run counter-clockwise.
struct Image {
  std::array<Vec2, 3> point;
  std::array<Index, 3> vertex;
  Index triangle = kNone;
  Box2 box;
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

double area_of(const Image& image) {
  const auto& p = image.point;
  return 0.5 * cross(p[1] - p[0], p[2] - p[0]);
}

void add_pair(const Image& a, const Image& b, In<double> rest_area, Overlaps& sum) {
  ++sum.pairs;
  const double common = common_area(a, b);
  sum.common_area += common;
  if (!rest_area.empty())
    sum.covered_rest_area +=
        common * (rest_area[a.triangle] / area_of(a) + rest_area[b.triangle] / area_of(b));
  sum.first.push_back({std::min(a.triangle, b.triangle), std::max(a.triangle, b.triangle)});
  keep_first(sum.first, 4 * kMaxListedIds);
}

BoxTree tree_of(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv) {
  std::vector<Box2> box(corner_vertex.size() / 3);
  exec.for_blocks(static_cast<Index>(box.size()), kBlock, [&](Index, Range r) {
    for (Index t = r.begin; t < r.end; ++t) {
      for (Index c = 3 * t; c < 3 * t + 3; ++c) box[t].add(uv[corner_vertex[c]]);
    }
  });
  return BoxTree(exec, box);
}

std::vector<Image> images_of(const Exec& exec, In<Index> order, In<Index> corner_vertex, In<Vec2> uv) {
  std::vector<Image> images(order.size());
  exec.for_blocks(static_cast<Index>(images.size()), kBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) images[k] = image_of(order[k], corner_vertex, uv);
  });
  return images;
}

/// Calls visit(block, a, b) for overlapping pairs, blocks in parallel.
class PairSearch {
 public:
  PairSearch(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv)
      : exec_(exec),
        tree_(tree_of(exec, corner_vertex, uv)),
        images_(images_of(exec, tree_.order(), corner_vertex, uv)) {}
  Index num_blocks() const { return Exec::num_blocks(tree_.num_leaves(), kLeavesPerBlock); }
  In<Image> images() const { return images_; }

  template <class Visit>
  void operator()(Visit visit) const {
    exec_.for_blocks(tree_.num_leaves(), kLeavesPerBlock, [&](Index block, Range r) {
      const auto compare = [&](const Image& a, const Image& b) {
        if (a.box.meets(b.box) && !share_vertex(a, b) && share_interior(a, b)) visit(block, a, b);
      };
      for (Index leaf = r.begin; leaf < r.end; ++leaf) {
        const Range mine = tree_.leaf(leaf);
        tree_.visit_meeting(tree_.leaf_box(leaf), leaf, [&](Index other) {
          const Range theirs = tree_.leaf(other);
          for (Index i = mine.begin; i < mine.end; ++i) {
            for (Index j = other == leaf ? i + 1 : theirs.begin; j < theirs.end; ++j)
              compare(images_[i], images_[j]);
          }
        });
      }
    });
  }

 private:
  static constexpr Index kLeavesPerBlock = 256;
  const Exec& exec_;
  BoxTree tree_;
  std::vector<Image> images_;  // in the order of its leaves
};

}  // namespace

double common_image_area(In<Index> corner_vertex, In<Vec2> uv, Index s, Index t) {
  const Image a = image_of(s, corner_vertex, uv), b = image_of(t, corner_vertex, uv);
  return a.box.meets(b.box) && share_interior(a, b) ? common_area(a, b) : 0;
}

Overlaps find_overlaps(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv, In<double> rest_area) {
  const PairSearch search(exec, corner_vertex, uv);
  std::vector<Overlaps> part(search.num_blocks());
  search([&](Index block, const Image& a, const Image& b) { add_pair(a, b, rest_area, part[block]); });
  Overlaps all;
  for (const Overlaps& p : part) {
    all.pairs += p.pairs;
    all.common_area += p.common_area;
    all.covered_rest_area += p.covered_rest_area;
    all.first.insert(all.first.end(), p.first.begin(), p.first.end());
  }
  all.map_area = exec.sum_blocks(static_cast<Index>(search.images().size()), kBlock, [&](Range r) {
    double sum = 0;
    for (Index i = r.begin; i < r.end; ++i) sum += area_of(search.images()[i]);
    return sum;
  });
  keep_first(all.first, 0);
  return all;
}

std::vector<Index> overlapping_triangles(const Exec& exec, In<Index> corner_vertex, In<Vec2> uv) {
  const PairSearch search(exec, corner_vertex, uv);
  std::vector<std::vector<Index>> part(search.num_blocks());
  search([&](Index block, const Image& a, const Image& b) {
    part[block].push_back(a.triangle);
    part[block].push_back(b.triangle);
  });
  std::vector<Index> all;
  for (const std::vector<Index>& p : part) all.insert(all.end(), p.begin(), p.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace planish
