#include "io/polyline_chain.hpp"

#include <algorithm>
#include <tuple>

#include "engine/model/error.hpp"

namespace planish {
namespace {

using Segment = std::array<Index, 2>;

/// The chain as a graph: nodes are the distinct positions, each with its one or two segments.
class ChainJoiner {
 public:
  ChainJoiner(In<Vec3> point, In<Segment> segment) : point_(point), segment_(segment) {}

  ChainOfSegments run() {
    merge_equal_positions();
    check_lengths();
    if (!result_.fault) attach_segments();
    if (!result_.fault) walk();
    if (!result_.fault) check_pieces();
    if (result_.fault) result_.polyline = {};
    return std::move(result_);
  }

 private:
  /// node_ [2 S] of the ends of segments; representative_ [N] the lowest point at each position.
  void merge_equal_positions() {
    const auto num_ends = static_cast<Index>(2 * segment_.size());
    std::vector<Index> end(static_cast<std::size_t>(num_ends));
    for (Index e = 0; e < num_ends; ++e) end[e] = e;
    const auto key = [&](Index e) {
      const Vec3& p = point_[point_of(e)];
      return std::tuple(p.x, p.y, p.z);
    };
    std::ranges::sort(end, {}, [&](Index e) { return std::tuple_cat(key(e), std::tuple(point_of(e), e)); });
    node_.resize(end.size());
    for (std::size_t k = 0; k < end.size(); ++k) {
      if (k == 0 || key(end[k]) != key(end[k - 1])) representative_.push_back(point_of(end[k]));
      node_[end[k]] = static_cast<Index>(representative_.size()) - 1;
    }
  }

  void check_lengths() {
    std::vector<Index> bad;
    for (std::size_t s = 0; s < segment_.size(); ++s) {
      if (node_[2 * s] == node_[2 * s + 1]) bad.push_back(static_cast<Index>(s));
    }
    if (bad.empty()) return;
    std::vector<Index> points;
    for (const Index s : bad) points.push_back(segment_[s][0]);
    fault("a segment without length", std::move(points), static_cast<std::size_t>(bad.front()));
  }

  /// attached_ [N] the segments of a node, the first two of them.
  void attach_segments() {
    attached_.assign(representative_.size(), {kNone, kNone});
    std::vector<Index> branching;
    std::size_t first = 0;
    for (std::size_t e = 0; e < node_.size(); ++e) {
      Segment& two = attached_[node_[e]];
      Index& free = two[0] == kNone ? two[0] : two[1];
      if (free == kNone) {
        free = static_cast<Index>(e / 2);
      } else {
        if (branching.empty()) first = e / 2;
        branching.push_back(representative_[node_[e]]);
      }
    }
    if (!branching.empty()) fault("the polyline branches", std::move(branching), first);
  }

  /// From the begin of the chain, or of the first segment where it is closed.
  void walk() {
    visited_.assign(segment_.size(), 0);
    const Index begin = begin_of_chain();
    PolylineSource& polyline = result_.polyline;
    polyline.point.reserve(segment_.size() + 1);
    Index node = begin, segment = begin == node_[0] ? 0 : attached_[begin][0];
    while (segment != kNone && visited_[segment] == 0) {
      polyline.point.push_back(point_[representative_[node]]);
      visited_[segment] = 1;
      node = across(node, segment);
      segment = next(node, segment);
    }
    polyline.closed = node == begin;
    if (!polyline.closed) polyline.point.push_back(point_[representative_[node]]);
    if (polyline.closed && polyline.point.size() < 3)
      fault("a closed polyline needs three points", {representative_[begin]}, 0);
  }

  /// Backwards from the first segment until there is no other, or it is met again.
  Index begin_of_chain() const {
    Index node = node_[0], segment = 0;
    for (Index before = next(node, segment); before != kNone; before = next(node, segment)) {
      node = across(node, before);
      segment = before;
      if (segment == 0) return node_[0];
    }
    return node;
  }

  void check_pieces() {
    std::vector<Index> elsewhere;
    std::size_t first = 0;
    for (std::size_t s = 0; s < segment_.size(); ++s) {
      if (visited_[s] != 0) continue;
      if (elsewhere.empty()) first = s;
      for (const Index p : segment_[s]) elsewhere.push_back(p);
    }
    if (!elsewhere.empty())
      fault("the polyline has several pieces, these points are not joined to its first segment",
            std::move(elsewhere), first);
  }

  void fault(std::string what, std::vector<Index> points, std::size_t segment) {
    std::ranges::sort(points);
    points.erase(std::ranges::unique(points).begin(), points.end());
    const auto count = static_cast<Offset>(points.size());
    points.resize(std::min(points.size(), kMaxListedIds));
    result_.fault = ChainFault{std::move(what), std::move(points), count, segment};
  }

  Index point_of(Index end) const { return segment_[end / 2][end % 2]; }
  Index across(Index node, Index s) const { return node_[2 * s] == node ? node_[2 * s + 1] : node_[2 * s]; }
  Index next(Index node, Index s) const {
    return attached_[node][0] == s ? attached_[node][1] : attached_[node][0];
  }

  In<Vec3> point_;
  In<Segment> segment_;
  std::vector<Index> node_, representative_;
  std::vector<Segment> attached_;
  std::vector<char> visited_;
  ChainOfSegments result_;
};

}  // namespace

ChainOfSegments join_segments(In<Vec3> point, In<Segment> segment) {
  return ChainJoiner(point, segment).run();
}

}  // namespace planish
