#include "engine/features/sharp_edges.hpp"

#include <algorithm>

#include "engine/features/feature_error.hpp"
#include "engine/features/nearest.hpp"

namespace planish {
namespace {

constexpr double kCosineOfLargestTurn = 0.5;  // 60 degrees

/// Edges as half-edges: sharp ones are interior, so each has one leaving either end.
class Creases {
 public:
  Creases(const Surface& surface, const Topology& topology, double degrees)
      : surface_(surface), topology_(topology), degrees_(degrees) {}

  Index tail(Index c) const { return surface_.corner_vertex[c]; }
  Index head(Index c) const { return surface_.corner_vertex[next_corner(c)]; }
  Vec3 position(Index v) const { return surface_.position[v]; }
  Index twin(Index c) const { return topology_.corner_twin[c]; }

  /// Angle between the normals on both sides, degrees; 0 on the boundary.
  double angle(Index c) const {
    if (twin(c) == kNone) return 0;
    const Vec3 left = normal(c / 3), right = normal(twin(c) / 3);
    return std::atan2(norm(cross(left, right)), dot(left, right)) * (180 / kPi);
  }
  bool is_sharp(Index c) const { return angle(c) > degrees_; }

  /// The half-edge that continues c at its head, or kNone.
  Index next(Index c) const {
    const Index back = twin(c), onward = partner(back);
    return onward != kNone && partner(onward) == back ? onward : kNone;
  }

 private:
  Vec3 normal(Index t) const {
    const Vec3 a = position(tail(3 * t)), b = position(tail(3 * t + 1)), c = position(tail(3 * t + 2));
    const Vec3 n = cross(b - a, c - a);
    const double length = norm(n);
    return length > 0 ? 1 / length * n : n;
  }

  double cosine_of_turn(Index back, Index onward) const {
    const Vec3 in = position(tail(back)) - position(head(back)),
               out = position(head(onward)) - position(tail(onward));
    return dot(in, out) / (norm(in) * norm(out));
  }

  /// Of the other sharp half-edges that leave the same vertex the only one, or the only one nearly straight on.
  Index partner(Index back) const {
    Index others = 0, straight_ones = 0, other = kNone, straight = kNone;
    for (const Index c : slice(In<Index>(topology_.star_corner), topology_.stars().group(tail(back)))) {
      if (c == back || !is_sharp(c)) continue;
      ++others, other = c;
      if (cosine_of_turn(back, c) > kCosineOfLargestTurn) ++straight_ones, straight = c;
    }
    if (others == 1) return other;
    return straight_ones == 1 ? straight : kNone;
  }

  const Surface& surface_;
  const Topology& topology_;
  double degrees_;
};

struct Candidate {
  double distance2 = kInfinity;
  double degrees = 0;
  Index corner = kNone;

  bool better_than(const Candidate& other) const {
    if (corner == kNone || other.corner == kNone) return other.corner == kNone && corner != kNone;
    if (distance2 != other.distance2) return distance2 < other.distance2;
    return degrees != other.degrees ? degrees > other.degrees : corner < other.corner;
  }
};

struct Scan {
  Candidate nearest;
  double sharpest = 0;  ///< degrees, of all edges
};

Scan scan(const Exec& exec, const Topology& topology, const Creases& creases,
          const SharpEdgesSource& source) {
  const auto num_corners = static_cast<Index>(topology.corner_twin.size());
  std::vector<Scan> partial(Exec::num_blocks(num_corners, kBlock));
  exec.for_blocks(num_corners, kBlock, [&](Index block, Range r) {
    Scan found;
    for (Index c = r.begin; c < r.end; ++c) {
      if (creases.twin(c) < c) continue;  // boundary, or seen from the other side
      const double degrees = creases.angle(c);
      found.sharpest = std::max(found.sharpest, degrees);
      if (!(degrees > source.degrees)) continue;
      const double d = squared_distance_to_segment(source.near, creases.position(creases.tail(c)),
                                                   creases.position(creases.head(c)));
      const Candidate candidate{d, degrees, c};
      if (candidate.better_than(found.nearest)) found.nearest = candidate;
    }
    partial[block] = found;
  });
  Scan all;
  for (const Scan& s : partial) {
    if (s.nearest.better_than(all.nearest)) all.nearest = s.nearest;
    all.sharpest = std::max(all.sharpest, s.sharpest);
  }
  return all;
}

/// One direction of growth. `first` is the half-edge at the other end of the path so far, pointing into it.
struct Growth {
  std::vector<Index> vertex;
  Index last = kNone;  ///< half-edge of the last step
  bool closed = false;
};

/// Both ends of a path arrive at one vertex: they close where they continue one another, or neither goes on.
bool closes(const Creases& creases, Index arriving, Index first) {
  if (creases.head(arriving) != creases.tail(first)) return false;
  const Index onward = creases.next(arriving);
  return onward == first || (onward == kNone && creases.next(creases.twin(first)) == kNone);
}

Growth grow(const Creases& creases, Index start, Index first, std::vector<std::uint8_t>& passed) {
  Growth growth{{}, start, false};
  for (Index c = creases.next(start); c != kNone; c = creases.next(c)) {
    const Index v = creases.head(c);
    if (passed[v]) {
      growth.closed = closes(creases, c, first);
      break;
    }
    passed[v] = 1;
    growth.vertex.push_back(v);
    growth.last = c;
  }
  return growth;
}

FoundChain path_through(const Creases& creases, Index seed, Index num_vertices) {
  std::vector<std::uint8_t> passed(num_vertices, 0);
  passed[creases.tail(seed)] = passed[creases.head(seed)] = 1;
  const Growth ahead = grow(creases, seed, seed, passed);
  Growth behind;
  if (!ahead.closed) behind = grow(creases, creases.twin(seed), creases.twin(ahead.last), passed);
  FoundChain chain{{behind.vertex.rbegin(), behind.vertex.rend()}, ahead.closed || behind.closed};
  chain.vertex.insert(chain.vertex.end(), {creases.tail(seed), creases.head(seed)});
  chain.vertex.insert(chain.vertex.end(), ahead.vertex.begin(), ahead.vertex.end());
  return chain;
}

void settle_start_and_direction(const Creases& creases, Vec3 near, FoundChain& chain) {
  auto& vertex = chain.vertex;
  const auto at = [&](Index v) { return creases.position(v); };
  if (!chain.closed) {
    if (comes_before(at(vertex.back()), at(vertex.front()))) std::reverse(vertex.begin(), vertex.end());
    return;
  }
  const auto nearer = [&](Index a, Index b) {
    const double da = norm(at(a) - near), db = norm(at(b) - near);
    return da != db ? da < db : comes_before(at(a), at(b));
  };
  std::rotate(vertex.begin(), std::min_element(vertex.begin(), vertex.end(), nearer), vertex.end());
  if (comes_before(at(vertex.back()), at(vertex[1]))) std::reverse(vertex.begin() + 1, vertex.end());
}

}  // namespace

Result<FoundChain> chain_of_sharp_edges(const Exec& exec, const Surface& surface, const Topology& topology,
                                        const std::string& name, const SharpEdgesSource& source) {
  const auto broken = [&](const std::string& what) {
    return fail(feature_error(ErrorCode::FeatureBroken, name, what));
  };
  if (!(source.degrees >= 0 && source.degrees < 180))
    return broken("the angle of \"sharp_edges\" must be at least 0 and below 180 degrees");
  if (!is_finite_point(source.near)) return broken("a coordinate of \"near\" is not a finite number");
  const Creases creases(surface, topology, source.degrees);
  const Scan found = scan(exec, topology, creases, source);
  if (found.nearest.corner == kNone) {
    return broken("no edge is bent by more than " + in_words(source.degrees) + " degrees; the sharpest has " +
                  in_words(found.sharpest));
  }
  FoundChain chain = path_through(creases, found.nearest.corner, surface.num_vertices());
  settle_start_and_direction(creases, source.near, chain);
  return chain;
}

}  // namespace planish
