#include "engine/verify/written_map.hpp"

#include <algorithm>

namespace planish {

WrittenMap::WrittenMap(const Surface& surface, In<Vec2> corner_uv)
    : surface_(surface),
      corner_uv_(corner_uv),
      star_begin_(surface.position.size() + 1, 0),
      star_corner_(corner_uv.size()) {
  for (const Index v : surface.corner_vertex) ++star_begin_[v + 1];
  for (Index v = 0; v < num_vertices(); ++v) star_begin_[v + 1] += star_begin_[v];
  std::vector<Index> next(star_begin_.begin(), star_begin_.end() - 1);
  for (Index c = 0; c < static_cast<Index>(corner_uv.size()); ++c) star_corner_[next[vertex(c)]++] = c;
}

In<Index> WrittenMap::corners_of(Index v) const {
  return In<Index>(star_corner_).subspan(star_begin_[v], star_begin_[v + 1] - star_begin_[v]);
}

Index WrittenMap::corner(Index t, Index v) const {
  Index c = 3 * t;
  while (vertex(c) != v) ++c;
  return c;
}

Index WrittenMap::triangle_of(Index a, Index b) const {
  for (const Index c : corners_of(a)) {
    if (vertex(next_corner(c)) == b) return c / 3;
  }
  return kNone;
}

Index WrittenMap::triangle_beside(Index a, Index b, int side) const {
  const Index left = triangle_of(a, b), right = triangle_of(b, a);
  if (side == 2) return right == kNone ? left : right;
  return left == kNone ? right : left;
}

bool WrittenMap::is_torn(Index a, Index b) const {
  const Index left = triangle_of(a, b), right = triangle_of(b, a);
  if (left == kNone || right == kNone) return false;
  return uv(corner(left, a)) != uv(corner(right, a)) || uv(corner(left, b)) != uv(corner(right, b));
}

std::vector<Vec2> WrittenMap::images(Index v) const {
  std::vector<Vec2> images;
  for (const Index c : corners_of(v)) {
    if (std::find(images.begin(), images.end(), uv(c)) == images.end()) images.push_back(uv(c));
  }
  return images;
}

double WrittenMap::extent() const {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  for (const Vec2 z : corner_uv_) {
    lower = {std::min(lower.x, z.x), std::min(lower.y, z.y)};
    upper = {std::max(upper.x, z.x), std::max(upper.y, z.y)};
  }
  return norm(upper - lower);
}

}  // namespace planish
