#include "engine/prepare/cut.hpp"

#include <algorithm>

#include "kernels/topology/stars.hpp"

namespace planish {
namespace {

/// The fans of one star, found from its corners in rotation order.
class Fans {
 public:
  Fans(In<Index> twin, In<std::uint8_t> cut) : twin_(twin), cut_(cut) {}

  /// Number of fans of a star; 0 for a vertex without corners.
  Index count(In<Index> star) const {
    if (star.empty()) return 0;
    Index breaks = 0;
    for (Index c : star) breaks += is_cut_after(c);
    return is_closed(star) ? std::max<Index>(1, breaks) : 1 + breaks;
  }

  /// The corners from the first one after a cut (or boundary) edge on, and the smallest corner of each fan.
  void split(In<Index> star) {
    order_.assign(star.begin(), star.end());
    if (is_closed(star)) {
      const auto last = std::find_if(order_.begin(), order_.end(), [&](Index c) { return is_cut_after(c); });
      std::rotate(order_.begin(), last + 1, order_.end());
    }
    smallest_.assign(1, order_[0]);
    for (std::size_t k = 1; k < order_.size(); ++k) {
      if (is_cut_after(order_[k - 1])) smallest_.push_back(order_[k]);
      smallest_.back() = std::min(smallest_.back(), order_[k]);
    }
    rank_ = smallest_;
    std::sort(rank_.begin(), rank_.end());
  }

  /// body(corner, rank) for the corners of the star that was split; rank 0 is the fan of the smallest corner.
  template <class Body>
  void for_each_corner(Body&& body) const {
    std::size_t fan = 0;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (k > 0 && is_cut_after(order_[k - 1])) ++fan;
      const auto place = std::lower_bound(rank_.begin(), rank_.end(), smallest_[fan]);
      body(order_[k], static_cast<Index>(place - rank_.begin()));
    }
  }

 private:
  /// Whether the edge between c and the next corner of the star is cut.
  bool is_cut_after(Index c) const { return cut_[previous_corner(c)] != 0; }
  bool is_closed(In<Index> star) const { return twin_[star[0]] != kNone; }

  In<Index> twin_;
  In<std::uint8_t> cut_;
  std::vector<Index> order_, smallest_, rank_;
};

/// cut [3 T] 1 on both half-edges of interior edges to open.
std::vector<std::uint8_t> mark(In<Index> twin, In<Index> cut_corner) {
  std::vector<std::uint8_t> cut(twin.size(), 0);
  for (Index c : cut_corner) {
    if (twin[c] != kNone) cut[c] = cut[twin[c]] = 1;
  }
  return cut;
}

/// Counts the edges whose sides got different vertices and adds their lengths.
void measure_cut(const Exec& exec, In<Index> twin, In<std::uint8_t> cut, CutSurface& opened) {
  const auto num_corners = static_cast<Index>(twin.size());
  const auto& vertex = opened.corner_vertex;
  std::vector<Index> parted(Exec::num_blocks(num_corners, kBlock), 0);
  std::vector<double> length(parted.size(), 0);
  exec.for_blocks(num_corners, kBlock, [&](Index block, Range r) {
    for (Index c = r.begin; c < r.end; ++c) {
      if (!cut[c] || twin[c] < c) continue;
      const Index a = vertex[c], b = vertex[next_corner(c)];
      if (a == vertex[next_corner(twin[c])] && b == vertex[twin[c]]) continue;
      ++parted[block];
      length[block] += norm(opened.position[b] - opened.position[a]);
    }
  });
  for (Index n : parted) opened.num_cut_edges += n;
  opened.cut_length = pairwise_sum(length);
}

}  // namespace

CutSurface open_along(const Exec& exec, const Surface& surface, const Topology& topology,
                      In<Index> cut_corner) {
  const std::vector<std::uint8_t> cut = mark(topology.corner_twin, cut_corner);
  const auto star = [&](Index v) {
    return slice(In<Index>(topology.star_corner), topology.stars().group(v));
  };
  const Index num_vertices = surface.num_vertices();
  std::vector<Index> num_copies(num_vertices, 0);
  exec.for_blocks(num_vertices, kBlock, [&](Index, Range r) {
    const Fans fans(topology.corner_twin, cut);
    for (Index v = r.begin; v < r.end; ++v) num_copies[v] = std::max<Index>(1, fans.count(star(v))) - 1;
  });
  const std::vector<Index> copies_begin = exclusive_scan(num_copies);

  CutSurface opened;
  opened.position.assign(surface.position.begin(), surface.position.end());
  opened.position.resize(num_vertices + copies_begin.back());
  opened.corner_vertex.assign(surface.corner_vertex.begin(), surface.corner_vertex.end());
  opened.vertex_origin.resize(opened.position.size());
  exec.for_blocks(num_vertices, kBlock, [&](Index, Range r) {
    Fans fans(topology.corner_twin, cut);
    for (Index v = r.begin; v < r.end; ++v) {
      opened.vertex_origin[v] = v;
      if (num_copies[v] == 0) continue;
      fans.split(star(v));
      const Index first_copy = num_vertices + copies_begin[v];
      fans.for_each_corner([&](Index c, Index rank) {
        if (rank > 0) opened.corner_vertex[c] = first_copy + rank - 1;
      });
      for (Index k = 0; k < num_copies[v]; ++k) {
        opened.position[first_copy + k] = surface.position[v];
        opened.vertex_origin[first_copy + k] = v;
      }
    }
  });
  measure_cut(exec, topology.corner_twin, cut, opened);
  return opened;
}

std::vector<Index> torn_half_edges(In<Index> twin, In<Vec2> corner_uv) {
  std::vector<Index> torn;
  for (Index c = 0; c < static_cast<Index>(twin.size()); ++c) {
    const Index other = twin[c];
    if (other < c) continue;  // also on the boundary
    if (corner_uv[c] != corner_uv[next_corner(other)] || corner_uv[next_corner(c)] != corner_uv[other])
      torn.push_back(c);
  }
  return torn;
}

}  // namespace planish
