#include "engine/features/enclosed.hpp"

#include <algorithm>

#include "engine/features/feature_error.hpp"
#include "engine/features/nearest.hpp"
#include "engine/features/one_ring.hpp"

namespace planish {
namespace {

/// The sides of a chain as they are flooded: triangles are connected over edges that are not in the chain.
class Sides {
 public:
  Sides(const Surface& surface, const Topology& topology)
      : surface_(surface),
        topology_(topology),
        is_wall_(topology.corner_twin.size(), 0),
        reached_(surface.num_triangles(), 0) {}

  /// Enters the chain; the steps that are no edges come back.
  OffendingIds enter(In<Index> chain) {
    OffendingIds gaps;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Index a = chain[i], b = chain[(i + 1) % chain.size()];
      const Index left = half_edge(surface_, topology_, a, b), right = half_edge(surface_, topology_, b, a);
      if (left == kNone && right == kNone) gaps.add(a, b);
      if (left != kNone) left_.push_back(left), is_wall_[left] = 1;
      if (right != kNone) right_.push_back(right), is_wall_[right] = 1;
    }
    return gaps;
  }

  const std::vector<Index>& left() const { return left_; }
  const std::vector<Index>& right() const { return right_; }

  /// All triangles connected to the first ones that were not reached before, ascending; and in how many pieces.
  struct Flood {
    std::vector<Index> triangle;
    OffendingIds pieces;  ///< one triangle of each
  };
  Flood flood_from(In<Index> corners) {
    Flood flood;
    for (const Index c : corners) {
      if (reached_[c / 3]) continue;
      flood.pieces.add(c / 3);
      flood_piece(c / 3, flood.triangle);
    }
    std::sort(flood.triangle.begin(), flood.triangle.end());
    return flood;
  }

  bool reaches(In<Index> corners) const {
    return std::any_of(corners.begin(), corners.end(), [&](Index c) { return reached_[c / 3] != 0; });
  }

 private:
  /// The list is the queue.
  void flood_piece(Index first, std::vector<Index>& triangle) {
    reached_[first] = 1;
    std::size_t next = triangle.size();
    for (triangle.push_back(first); next < triangle.size(); ++next) {
      for (Index c = 3 * triangle[next]; c < 3 * triangle[next] + 3; ++c) {
        const Index twin = topology_.corner_twin[c];
        if (twin == kNone || is_wall_[c] || reached_[twin / 3]) continue;
        reached_[twin / 3] = 1;
        triangle.push_back(twin / 3);
      }
    }
  }

  const Surface& surface_;
  const Topology& topology_;
  std::vector<std::uint8_t> is_wall_;  ///< [3 T] half-edges of the chain, in both directions
  std::vector<std::uint8_t> reached_;  ///< [T]
  std::vector<Index> left_, right_;    ///< half-edges of the chain, in its direction and against it
};

Vec3 corner_position(const Surface& surface, Index c) { return surface.position[surface.corner_vertex[c]]; }

struct Nearest {
  Index triangle = kNone;
  double distance2 = kInfinity;
};

Nearest nearest_triangle(const Surface& surface, Vec3 p) {
  Nearest nearest;
  for (Index t = 0; t < surface.num_triangles(); ++t) {
    const Vec3 a = corner_position(surface, 3 * t), b = corner_position(surface, 3 * t + 1),
               c = corner_position(surface, 3 * t + 2);
    if (nearest.triangle != kNone && squared_distance_to_box(p, a, b, c) > nearest.distance2) continue;
    const double d = squared_distance_to_triangle(p, a, b, c);
    if (nearest.triangle == kNone || d < nearest.distance2) nearest = {t, d};
  }
  return nearest;
}

/// Whether the surface's point nearest to the seed lies on an edge of the chain that has two sides.
bool is_on_chain(const Surface& surface, const Topology& topology, const Sides& sides, Vec3 seed,
                 const Nearest& nearest) {
  double least = kInfinity, size = 0;
  for (const Index c : sides.left()) {
    const Vec3 a = corner_position(surface, c), b = corner_position(surface, next_corner(c));
    size = std::max(size, norm(b - a));
    if (topology.corner_twin[c] != kNone) least = std::min(least, squared_distance_to_segment(seed, a, b));
  }
  return std::sqrt(least) <= (1 + 1e-12) * std::sqrt(nearest.distance2) + 1e-12 * size;
}

double area(const Surface& surface, In<Index> triangles) {
  double sum = 0;
  for (const Index t : triangles) {
    const Vec3 a = corner_position(surface, 3 * t);
    sum += norm(cross(corner_position(surface, 3 * t + 1) - a, corner_position(surface, 3 * t + 2) - a)) / 2;
  }
  return sum;
}

/// Whether a chain of boundary edges is the longest loop of its component.
bool is_rim(const Topology& topology, Index corner) {
  for (Index l = 0; l < topology.num_loops(); ++l) {
    const auto corners = slice(In<Index>(topology.loop_corner), topology.loops().group(l));
    if (topology.triangle_component[corners.front() / 3] != topology.triangle_component[corner / 3]) continue;
    return std::find(corners.begin(), corners.end(), corner) != corners.end();
  }
  return false;
}

/// Words and codes of one call.
struct Wording {
  const std::string& name;
  const std::string& chain;

  Error broken(const std::string& what) const { return feature_error(ErrorCode::RegionBroken, name, what); }
  Error not_separating() const {
    return broken("\"" + chain + "\" does not separate the surface: its left and right are connected " +
                  "around it");
  }
};

using Triangles = Result<std::vector<Index>>;

Triangles side_of_seed(const Surface& surface, const Topology& topology, Sides& sides, Vec3 seed,
                       const Wording& say) {
  if (!is_finite_point(seed)) return fail(say.broken("a coordinate of \"seed\" is not a finite number"));
  const Nearest nearest = nearest_triangle(surface, seed);
  const Index chain_corner = sides.left().empty() ? sides.right().front() : sides.left().front();
  if (topology.triangle_component[nearest.triangle] != topology.triangle_component[chain_corner / 3]) {
    OffendingIds ids;
    ids.add(nearest.triangle);
    return fail(ids.of(say.broken("the seed is nearest to a triangle of another component than \"" +
                                  say.chain + "\"; move it nearer to the side that is meant"),
                       ElementKind::Triangle));
  }
  if (is_on_chain(surface, topology, sides, seed, nearest)) {
    return fail(say.broken("the point of the surface nearest to the seed is on \"" + say.chain +
                           "\" itself; move the seed to one side"));
  }
  const Index corner = 3 * nearest.triangle;
  auto flood = sides.flood_from({&corner, 1});
  if (sides.reaches(sides.left()) && sides.reaches(sides.right())) return fail(say.not_separating());
  return std::move(flood.triangle);
}

Triangles only_side(const Topology& topology, Sides& sides, const Wording& say) {
  const auto& corners = sides.left().empty() ? sides.right() : sides.left();
  if (is_rim(topology, corners.front())) return sides.flood_from(corners).triangle;
  return fail(say.broken("\"" + say.chain +
                         "\" is the loop of a hole, so the surface around it is its only " +
                         "side; give a \"seed\" on the surface if that is meant"));
}

Triangles smaller_side(const Surface& surface, Sides& sides, const Wording& say) {
  auto left = sides.flood_from(sides.left());
  if (sides.reaches(sides.right())) return fail(say.not_separating());
  auto right = sides.flood_from(sides.right());
  const double left_area = area(surface, left.triangle), right_area = area(surface, right.triangle);
  if (std::abs(left_area - right_area) <= 1e-9 * (left_area + right_area)) {
    return fail(say.broken("both sides of \"" + say.chain + "\" have the same area, " + in_words(left_area) +
                           "; give a \"seed\" on the one that is meant"));
  }
  auto& smaller = left_area < right_area ? left : right;
  if (smaller.pieces.count() == 1) return std::move(smaller.triangle);
  return fail(smaller.pieces.of(
      say.broken("the smaller side of \"" + say.chain + "\" is in " + std::to_string(smaller.pieces.count()) +
                 " pieces, each listed by one triangle; give a \"seed\" on the one that is meant"),
      ElementKind::Triangle));
}

}  // namespace

Result<std::vector<Index>> enclosed_triangles(const Surface& surface, const Topology& topology,
                                              const std::string& name, In<Index> chain, bool closed,
                                              const EnclosedBySource& source) {
  const Wording say{name, source.feature};
  if (!closed) {
    return fail(say.broken("\"" + say.chain + "\" is open; only a closed feature encloses triangles"));
  }
  if (chain.size() < 3) return fail(say.broken("\"" + say.chain + "\" has fewer than 3 vertices"));
  Sides sides(surface, topology);
  const OffendingIds gaps = sides.enter(chain);
  if (!gaps.empty()) {
    return fail(gaps.of(say.broken("consecutive vertices of \"" + say.chain + "\" share no edge"),
                        ElementKind::Edge));
  }
  if (source.seed) return side_of_seed(surface, topology, sides, *source.seed, say);
  if (sides.left().empty() || sides.right().empty()) return only_side(topology, sides, say);
  return smaller_side(surface, sides, say);
}

}  // namespace planish
