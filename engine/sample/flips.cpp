#include <algorithm>
#include <cmath>

#include "engine/sample/triangulate.hpp"

namespace planish {
namespace {

constexpr Index kStripBlock = 32;

/// Cosine of the smallest angle of a triangle given by its squared side lengths: the one across its shortest
/// side.
double cosine_of_smallest_angle(double a, double b, double c) {
  if (a > b) std::swap(a, b);
  if (a > c) std::swap(a, c);
  return (b + c - a) / (2 * std::sqrt(b * c));
}

/// twin [3 T] half-edge on the other side or kNone, read off the order in which strips are walked: the last
/// half-edge of a triangle looks back along its strip, one of the others lies on a row.
std::vector<Index> strip_twins(const Exec& exec, const RowPlan& plan, In<Index> corner_vertex) {
  std::vector<Index> twin(corner_vertex.size(), kNone);
  std::vector<Index> above(plan.num_vertices(), kNone), below(plan.num_vertices(), kNone);  // by first vertex
  exec.for_blocks(plan.strips, kStripBlock, [&](Index, Range r) {
    for (Index s = r.begin; s < r.end; ++s) {
      const Index begin = plan.strip_begin[s], end = plan.strip_begin[s + 1];
      for (Index t = begin; t < end; ++t) {
        const bool on_lower_row = corner_vertex[3 * t + 1] < plan.row_begin[s + 1];
        (on_lower_row ? above[corner_vertex[3 * t]] : below[corner_vertex[3 * t + 2]]) =
            3 * t + !on_lower_row;
        const Index ahead = 3 * t + on_lower_row, next = t + 1 < end ? t + 1 : begin;
        const Index back = 3 * next + 2;
        // Walks around rings come back to where they began; those along open strips do not.
        if (corner_vertex[back] == corner_vertex[next_corner(ahead)] &&
            corner_vertex[next_corner(back)] == corner_vertex[ahead]) {
          twin[ahead] = back;
          twin[back] = ahead;
        }
      }
    }
  });
  for (Index v = 0; v < plan.num_vertices(); ++v) {
    if (above[v] == kNone || below[v] == kNone) continue;
    twin[above[v]] = below[v];
    twin[below[v]] = above[v];
  }
  return twin;
}

/// Flips within triangles [begin, end), reading and writing nothing outside but positions.
class BlockFlips {
 public:
  BlockFlips(In<Vec2> chart, In<Vec3> position, Out<Index> corner_vertex, Out<Index> twin, Range triangles)
      : chart_(chart), position_(position), vertex_(corner_vertex), twin_(twin), range_(triangles) {}

  /// Visits every edge of `start`, then again those of triangles that changed.
  void run(Range start) {
    constexpr int kSweeps = 8;
    std::vector<unsigned char> dirty(range_.end - range_.begin, 0);
    std::fill(dirty.begin() + (start.begin - range_.begin), dirty.begin() + (start.end - range_.begin), 1);
    bool changed = true;
    for (int sweep = 0; sweep < kSweeps && changed; ++sweep) {
      changed = false;
      for (Index t = range_.begin; t < range_.end; ++t) {
        if (!dirty[t - range_.begin]) continue;
        dirty[t - range_.begin] = 0;
        for (Index c = 3 * t; c < 3 * t + 3; ++c) {
          if (!can_flip(c) || !flip_helps(c)) continue;
          flip(c);
          dirty[t - range_.begin] = dirty[twin_[next_corner(c)] / 3 - range_.begin] = 1;
          changed = true;
        }
      }
    }
  }

 private:
  bool inside(Index c) const { return c == kNone || (c >= 3 * range_.begin && c < 3 * range_.end); }

  /// The two triangles and those whose twins would be rewritten lie in the block.
  bool can_flip(Index c) const {
    const Index d = twin_[c];
    return d != kNone && inside(d) && inside(twin_[next_corner(c)]) && inside(twin_[next_corner(d)]);
  }

  double squared_length(Index v, Index w) const {
    const Vec3 d = position_[w] - position_[v];
    return dot(d, d);
  }
  double chart_area(Index u, Index v, Index w) const {
    return cross(chart_[v] - chart_[u], chart_[w] - chart_[u]);
  }

  bool flip_helps(Index c) const {
    const Index d = twin_[c];
    const Index a = vertex_[c], b = vertex_[d];
    const Index p = vertex_[previous_corner(c)], q = vertex_[previous_corner(d)];
    const double ab = squared_length(a, b), pq = squared_length(p, q);
    const double bp = squared_length(b, p), pa = squared_length(p, a);
    const double aq = squared_length(a, q), qb = squared_length(q, b);
    const double before =
        std::max(cosine_of_smallest_angle(ab, bp, pa), cosine_of_smallest_angle(ab, aq, qb));
    const double after = std::max(cosine_of_smallest_angle(pq, pa, aq), cosine_of_smallest_angle(pq, bp, qb));
    if (after >= before - 1e-9) return false;
    const double smallest = 0.1 * std::min(chart_area(a, b, p), chart_area(b, a, q));
    return chart_area(a, q, p) > smallest && chart_area(b, p, q) > smallest;
  }

  void link(Index c, Index d) {
    twin_[c] = d;
    if (d != kNone) twin_[d] = c;
  }

  /// a-b, seen from the triangles with apexes p and q, becomes p-q.
  void flip(Index c) {
    const Index d = twin_[c], c1 = next_corner(c), d1 = next_corner(d);
    const Index beyond_bp = twin_[c1], beyond_aq = twin_[d1];
    const Index p = vertex_[previous_corner(c)], q = vertex_[previous_corner(d)];
    vertex_[c1] = q;
    vertex_[d1] = p;
    link(c, beyond_aq);
    link(d, beyond_bp);
    link(c1, d1);
  }

  In<Vec2> chart_;
  In<Vec3> position_;
  Out<Index> vertex_;
  Out<Index> twin_;
  Range range_;
};

}  // namespace

void flip_to_larger_angles(const Exec& exec, const RowPlan& plan, In<Vec2> chart, In<Vec3> position,
                           std::vector<Index>& corner_vertex) {
  std::vector<Index> twin = strip_twins(exec, plan, corner_vertex);
  const auto triangles_of = [&](Index first_strip, Index last_strip) {
    return Range{plan.strip_begin[std::clamp<Index>(first_strip, 0, plan.strips)],
                 plan.strip_begin[std::clamp<Index>(last_strip, 0, plan.strips)]};
  };
  exec.for_blocks(plan.strips, kStripBlock, [&](Index, Range r) {
    const Range all = triangles_of(r.begin, r.end);
    BlockFlips(chart, position, corner_vertex, twin, all).run(all);
  });
  // Blocks moved by half of one, for the edges that the first ones had to leave alone.
  constexpr Index kHalf = kStripBlock / 2, kSeam = 3;
  exec.for_tasks(Exec::num_blocks(plan.strips, kStripBlock) - 1, [&](Index k) {
    const Index seam = (k + 1) * kStripBlock;
    BlockFlips(chart, position, corner_vertex, twin, triangles_of(seam - kHalf, seam + kHalf))
        .run(triangles_of(seam - kSeam, seam + kSeam));
  });
}

}  // namespace planish
