#include "engine/methods/intrinsic_triangulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/intrinsic/milnor.hpp"
#include "kernels/topology/stars.hpp"

namespace planish {
namespace {

/// Six half-edges of the two triangles at an edge: c i -> j, n j -> k, p k -> i and d j -> i, dn i -> l, dp l -> j.
struct Quad {
  Index c, n, p, d, dn, dp;
};

Quad quad_at(Index c, In<Index> twin) {
  const Index d = twin[c];
  return {c, next_corner(c), previous_corner(c), d, next_corner(d), previous_corner(d)};
}

/// Twice the cosine of the angle opposite an edge, and how large the terms were; of edges that close in no triangle too.
struct DoubledCosine {
  double value, terms;
};
DoubledCosine doubled_cosine(double opposite, double a, double b) {
  const double first = std::exp(a - b), second = std::exp(b - a), third = std::exp(2 * opposite - a - b);
  return {first + second - third, first + second + third};
}

class Flipping {
 public:
  Flipping(const Exec& exec, IntrinsicTriangulation& triangulation) : exec_(exec), on_(triangulation) {}

  /// scaled: of a half-edge, the logarithm of its length;  across: that of the other diagonal, which the flip makes the edge
  template <class Scaled, class Across>
  Result<Index> operator()(const Scaled& scaled, const Across& across) {
    const Index most = on_.num_triangles() > kNoLimit ? std::numeric_limits<Index>::max()
                                                      : kFlipsATriangle * on_.num_triangles();
    find_candidates(scaled);
    Index flips = 0;
    while (!queue_.empty()) {
      const Index c = queue_.back();
      queue_.pop_back();
      queued_[c] = 0;
      if (is_delaunay(c, scaled)) continue;
      if (++flips > most)
        return fail(ErrorCode::NoConvergence, "flips of edges towards a Delaunay triangulation do not end");
      flip(c, across(quad_at(c, twin())));
    }
    if (flips > 0) rebuild_stars();
    return flips;
  }

 private:
  static constexpr Index kFlipsATriangle = 1000,
                         kNoLimit = std::numeric_limits<Index>::max() / kFlipsATriangle;

  std::vector<Index>& twin() { return on_.topology.corner_twin; }

  /// An edge that one triangle has twice stays.
  template <class Scaled>
  bool is_delaunay(Index c, const Scaled& scaled) const {
    constexpr double kRounding = 1e-13;
    const In<Index> twins = on_.topology.corner_twin;
    if (twins[c] == kNone || twins[c] / 3 == c / 3) return true;
    const Quad q = quad_at(c, twins);
    const double edge = scaled(c);
    const DoubledCosine one = doubled_cosine(edge, scaled(q.n), scaled(q.p)),
                        other = doubled_cosine(edge, scaled(q.dn), scaled(q.dp));
    return one.value + other.value >= -kRounding * (one.terms + other.terms);
  }

  template <class Scaled>
  void find_candidates(const Scaled& scaled) {
    const auto num_corners = static_cast<Index>(on_.corner_vertex.size());
    queued_.assign(num_corners, 0);
    exec_.for_blocks(num_corners, kBlock, [&](Index, Range r) {
      for (Index c = r.begin; c < r.end; ++c)
        queued_[c] = c < on_.topology.corner_twin[c] && !is_delaunay(c, scaled);
    });
    for (Index c = num_corners - 1; c >= 0; --c) {
      if (queued_[c]) queue_.push_back(c);
    }
  }

  void enqueue(Index c) {
    if (queued_[c]) return;
    queued_[c] = 1;
    queue_.push_back(c);
  }

  void join(Index a, Index b) {
    twin()[a] = b;
    if (b != kNone) twin()[b] = a;
  }

  /// Triangles i j k and j i l become i l k and j k l, in the same places.
  void flip(Index edge, double length) {
    const Quad q = quad_at(edge, twin());
    const auto moved = [&](Index h) { return h == q.n ? q.d : h == q.dn ? q.c : h; };
    const Index beyond_n = moved(twin()[q.n]), beyond_dn = moved(twin()[q.dn]);
    on_.log_length[q.d] = on_.log_length[q.n];
    on_.log_length[q.c] = on_.log_length[q.dn];
    on_.log_length[q.n] = on_.log_length[q.dn] = length;
    on_.corner_vertex[q.n] = on_.corner_vertex[q.dp];
    on_.corner_vertex[q.dn] = on_.corner_vertex[q.p];
    join(q.d, beyond_n);
    join(q.c, beyond_dn);
    join(q.n, q.dn);
    for (const Index h : {q.c, q.p, q.d, q.dp}) enqueue(h);
  }

  void rebuild_stars() {
    Topology& topology = on_.topology;
    const auto num_vertices = static_cast<Index>(topology.star_begin.size()) - 1;
    std::fill(topology.star_begin.begin(), topology.star_begin.end(), 0);
    for (const Index v : on_.corner_vertex) ++topology.star_begin[v + 1];
    for (Index v = 0; v < num_vertices; ++v) topology.star_begin[v + 1] += topology.star_begin[v];
    std::vector<Index> place(topology.star_begin.begin(), topology.star_begin.end() - 1);
    for (Index c = 0; c < static_cast<Index>(on_.corner_vertex.size()); ++c)
      topology.star_corner[place[on_.corner_vertex[c]]++] = c;
    std::vector<Index> scratch(topology.star_corner.size());
    exec_.for_blocks(num_vertices, kBlock, [&](Index, Range r) {
      rotate_stars(r, topology.corner_twin, topology.stars(), topology.star_corner, scratch,
                   topology.single_fan);
    });
    topology.edge_kind.clear();
    topology.loop_begin.clear();
    topology.loop_corner.clear();
    topology.loop_length.clear();
  }

  const Exec& exec_;
  IntrinsicTriangulation& on_;
  std::vector<Index> queue_;          // half-edges; those that are flipped come again
  std::vector<std::uint8_t> queued_;  // [3 T]
};

/// log (e^a + e^b)
double log_sum(double a, double b) { return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b))); }

}  // namespace

Result<Index> flip_to_delaunay(const Exec& exec, IntrinsicTriangulation& triangulation) {
  const In<double> length = triangulation.log_length;
  const auto across = [&](const Quad& q) {
    const double at_i = triangle_angles({length[q.n], length[q.p], length[q.c]}).angle[0] +
                        triangle_angles({length[q.dp], length[q.c], length[q.dn]}).angle[0];
    const double a = length[q.p], b = length[q.dn], difference = std::sinh(0.5 * (a - b));
    const double half = std::sin(0.5 * at_i);
    return 0.5 * (a + b) + 0.5 * std::log(4 * (difference * difference + half * half));
  };
  return Flipping(exec, triangulation)([&](Index c) { return length[c]; }, across);
}

Result<Index> flip_to_delaunay(const Exec& exec, In<double> u, IntrinsicTriangulation& triangulation) {
  const In<double> length = triangulation.log_length;
  const In<Index> vertex = triangulation.corner_vertex;
  const auto scaled = [&](Index c) { return length[c] + 0.5 * (u[vertex[c]] + u[vertex[next_corner(c)]]); };
  const auto across = [&](const Quad& q) {
    return log_sum(length[q.n] + length[q.dn], length[q.p] + length[q.dp]) - length[q.c];
  };
  return Flipping(exec, triangulation)(scaled, across);
}

}  // namespace planish
