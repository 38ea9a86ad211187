#include "engine/features/simple_pieces.hpp"

#include <algorithm>
#include <unordered_map>

namespace planish {
namespace {

bool passes_a_vertex_twice(const WalkPiece& walk) {
  std::vector<Index> vertices;
  for (const WalkPoint& p : walk.point) {
    if (p.vertex != kNone) vertices.push_back(p.vertex);
  }
  std::sort(vertices.begin(), vertices.end());
  return std::adjacent_find(vertices.begin(), vertices.end()) != vertices.end();
}

/// A closed walk starts at the tip of a spur where it has one, so that no spur is cut in two.
void start_at_a_tip(WalkPiece& walk) {
  const std::size_t n = walk.point.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Index before = walk.point[(i + n - 1) % n].vertex, after = walk.point[(i + 1) % n].vertex;
    if (before == kNone || before != after) continue;
    std::rotate(walk.point.begin(), walk.point.begin() + static_cast<std::ptrdiff_t>(i), walk.point.end());
    return;
  }
}

/// The walk so far without what was taken off it.
class Unraveller {
 public:
  std::vector<WalkPiece> run(const WalkPiece& walk) {
    for (const WalkPoint& p : walk.point) {
      const auto known = p.vertex == kNone ? place_.end() : place_.find(p.vertex);
      if (known != place_.end()) {
        come_back(known->second, p);
      } else {
        go_on(p);
      }
    }
    if (walk.closed) come_back(0, walk.point.front());
    end_spur();
    if (path_.size() > 1) pieces_.push_back({std::move(path_), false});
    return std::move(pieces_);
  }

 private:
  void go_on(const WalkPoint& p) {
    end_spur();
    if (p.vertex != kNone) place_[p.vertex] = path_.size();
    path_.push_back(p);
  }

  void come_back(std::size_t place, const WalkPoint& p) {
    const auto first = path_.begin() + static_cast<std::ptrdiff_t>(place);
    if (path_.end() - first == 2) {  // the last step is taken back
      spur_.push_back(spur_.empty() ? path_.back() : spur_base_);
      spur_base_ = *first;
    } else {
      end_spur();
      if (path_.end() - first > 2) pieces_.push_back({{first, path_.end()}, true});
    }
    for (auto it = first + 1; it != path_.end(); ++it) place_.erase(it->vertex);
    path_.resize(place + 1);
    path_.back() = p;
  }

  void end_spur() {
    if (spur_.empty()) return;
    spur_.push_back(spur_base_);
    std::reverse(spur_.begin(), spur_.end());
    pieces_.push_back({std::move(spur_), false});
    spur_.clear();
  }

  std::vector<WalkPiece> pieces_;
  std::vector<WalkPoint> path_;
  std::unordered_map<Index, std::size_t> place_;  ///< of the vertices in path_
  std::vector<WalkPoint> spur_;                   ///< steps taken back, the tip first
  WalkPoint spur_base_;                           ///< as the walk first left it, to the tip
};

}  // namespace

std::vector<WalkPiece> simple_pieces(WalkPiece walk) {
  const std::size_t least = walk.closed ? 3 : 2;
  if (walk.point.size() >= least && !passes_a_vertex_twice(walk)) return {std::move(walk)};
  if (walk.point.size() < 2) return {};
  if (walk.closed) start_at_a_tip(walk);
  return Unraveller().run(walk);
}

}  // namespace planish
