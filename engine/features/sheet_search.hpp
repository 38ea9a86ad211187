// Whether two places of a surface are on one sheet: joined by a path on it that stays near a segment in space.
#pragma once

#include <vector>

#include "engine/features/surface_locator.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// A straight piece of a polyline.
struct Segment {
  Vec3 begin, end;
};

/// All points within `radius` of a segment.
struct Capsule {
  Segment axis;
  double radius = 0;
  bool meets(const Segment& edge) const;
  bool contains(Vec3 p) const { return meets({p, p}); }
};

/// A set of triangles that costs what it holds: open addressing, cleared by what was put in.
class TriangleSet {
 public:
  TriangleSet() : slot_(64, kNone) {}
  /// True where t is new.
  bool insert(Index t) {
    if (2 * member_.size() >= slot_.size()) grow();
    const std::size_t at = place(t);
    if (slot_[at] == t) return false;
    slot_[at] = t;
    member_.push_back(t);
    return true;
  }
  void clear() {
    if (member_.size() * 8 > slot_.size()) {
      std::ranges::fill(slot_, kNone);
    } else {  // in the reverse order, so that each is still found
      for (auto t = member_.rbegin(); t != member_.rend(); ++t) slot_[place(*t)] = kNone;
    }
    member_.clear();
  }
  const std::vector<Index>& members() const { return member_; }

 private:
  std::size_t place(Index t) const {
    const std::size_t mask = slot_.size() - 1;
    std::size_t at = (static_cast<std::uint64_t>(t) * 0x9E3779B97F4A7C15ull >> 32) & mask;
    while (slot_[at] != kNone && slot_[at] != t) at = (at + 1) & mask;
    return at;
  }
  void grow() {
    slot_.assign(2 * slot_.size(), kNone);
    for (const Index t : member_) slot_[place(t)] = t;
  }
  std::vector<Index> slot_;
  std::vector<Index> member_;
};

/// Connection of points over the surface within capsules; scratch is kept from one search to the next.
class SheetSearch {
 public:
  using Hit = SurfaceLocator::Hit;

  /// Keeps references. Pre: topology is the surface's.
  SheetSearch(const Surface& surface, const Topology& topology) : surface_(surface), topology_(topology) {}

  /// A path on the surface joins a to b within the capsule. Exact: the part of a triangle in a capsule is
  /// convex, so triangles are joined in it just where their common edge meets it.
  /// Cost: O(triangles between them) where the way is straight, else O(k log k) for the k within the capsule.
  bool joined(const Hit& a, const Hit& b, const Capsule& capsule);

  /// The closest point to `query` on the triangles that the last joined(), having said no, reached.
  Hit closest_reached(Vec3 query) const;

 private:
  Vec3 corner(Index c) const { return surface_.position[surface_.corner_vertex[c]]; }
  Segment edge(Index c) const { return {corner(c), corner(next_corner(c))}; }
  Vec3 normal(Index t) const;
  Vec3 crossing(Index c, Vec3 origin, Vec3 across) const;
  bool is_common(Index corner, Index t, const Capsule& capsule) const;
  bool walks(const Hit& a, const Hit& b, const Capsule& capsule) const;
  bool explore(const Hit& a, const Hit& b, const Capsule& capsule);

  struct Open {
    double key;
    Index triangle;
    friend auto operator<=>(const Open&, const Open&) = default;
  };

  const Surface& surface_;
  const Topology& topology_;
  TriangleSet reached_;
  std::vector<Open> open_;
};

}  // namespace planish
