#include "engine/verify/simple_boundary.hpp"

#include <algorithm>
#include <atomic>

#include "engine/verify/box_tree.hpp"
#include "kernels/exact/orient2.hpp"

namespace planish {
namespace {

/// A half-edge of the boundary and where it lies.
struct Edge {
  Index tail, head;
  Vec2 from, to;
};

/// Closed segments whose boxes meet have a point in common. Not asked of edges that follow one another: where one runs back over
/// the other, that one's other neighbour touches it.
bool meet(const Edge& e, const Edge& f) {
  if (e.head == f.tail || f.head == e.tail) return false;
  return orient2(e.from, e.to, f.from) * orient2(e.from, e.to, f.to) <= 0 &&
         orient2(f.from, f.to, e.from) * orient2(f.from, f.to, e.to) <= 0;
}

Box2 box_of(In<Edge> edges) {
  Box2 box;
  for (const Edge& e : edges) box.add(e.from);
  return box;
}

/// No two edges meet.
bool is_simple(const Exec& exec, In<Edge> edges) {
  const Box2 whole = box_of(edges);
  const Vec2 size = whole.upper - whole.lower;
  const Vec2 farthest{std::max(std::abs(whole.lower.x), std::abs(whole.upper.x)),
                      std::max(std::abs(whole.lower.y), std::abs(whole.upper.y))};
  const double margin =
      1e-15 * std::max({size.x, size.y, farthest.x, farthest.y});  // boxes of no width meet nothing
  const auto n = static_cast<Index>(edges.size());
  std::vector<Box2> box(n);
  for (Index k = 0; k < n; ++k) {
    box[k].add(edges[k].from);
    box[k].add(edges[k].to);
    box[k] = box[k].grown(margin);
  }
  const BoxTree tree(exec, box);
  std::atomic<bool> simple = true;
  exec.for_blocks(n, kBlock, [&](Index, Range r) {
    for (Index e = r.begin; e < r.end && simple; ++e) {
      tree.visit_meeting(box[e], 0, [&](Index leaf) {
        const Range places = tree.leaf(leaf);
        for (Index i = places.begin; i < places.end; ++i) {
          const Index f = tree.order()[i];
          if (f > e && box[f].meets(box[e]) && meet(edges[e], edges[f])) simple = false;
        }
      });
    }
  });
  return simple;
}

/// Of a simple loop: its turn where it lies farthest left, and lowest there.
bool is_counter_clockwise(In<Edge> loop) {
  const auto before = [](const Edge& a, const Edge& b) {
    return a.from.x < b.from.x || (a.from.x == b.from.x && a.from.y < b.from.y);
  };
  const auto out = std::min_element(loop.begin(), loop.end(), before);
  const Edge& in = out == loop.begin() ? loop.back() : *(out - 1);
  return orient2(in.from, out->from, out->to) > 0;
}

class Boundaries {
 public:
  Boundaries(In<Index> corner_vertex, const Topology& topology, In<Vec2> uv)
      : corner_vertex_(corner_vertex), topology_(topology), uv_(uv), loops_(topology.num_components) {
    for (Index l = 0; l < topology.num_loops(); ++l)
      loops_[topology.triangle_component[loop(l).front() / 3]].push_back(l);
  }

  /// Edges of a component's loops, one loop after the other.
  std::vector<Edge> edges(Index component) const {
    std::vector<Edge> edges;
    for (const Index l : loops_[component]) append(l, edges);
    return edges;
  }

  bool has_one_outer_loop(Index component) const {
    Index num = 0;
    for (const Index l : loops_[component]) {
      std::vector<Edge> edges;
      append(l, edges);
      num += is_counter_clockwise(edges);
    }
    return num == 1;
  }

 private:
  In<Index> loop(Index l) const {
    return slice(In<Index>(topology_.loop_corner), topology_.loops().group(l));
  }
  void append(Index l, std::vector<Edge>& edges) const {
    for (const Index c : loop(l)) {
      const Index tail = corner_vertex_[c], head = corner_vertex_[next_corner(c)];
      edges.push_back({tail, head, uv_[tail], uv_[head]});
    }
  }

  In<Index> corner_vertex_;
  const Topology& topology_;
  In<Vec2> uv_;
  std::vector<std::vector<Index>> loops_;  // of each component
};

bool are_apart(const Exec& exec, In<Box2> box) {
  const BoxTree tree(exec, box);
  bool apart = true;
  for (Index k = 0; k < static_cast<Index>(box.size()) && apart; ++k) {
    tree.visit_meeting(box[k], 0, [&](Index leaf) {
      const Range places = tree.leaf(leaf);
      for (Index i = places.begin; i < places.end; ++i)
        apart &= tree.order()[i] == k || !box[tree.order()[i]].meets(box[k]);
    });
  }
  return apart;
}

}  // namespace

std::vector<std::uint8_t> components_covering_once(const Exec& exec, In<Index> corner_vertex,
                                                   const Topology& topology, In<Vec2> uv) {
  const Boundaries boundaries(corner_vertex, topology, uv);
  std::vector<std::uint8_t> once(topology.num_components, 1);
  const auto is_not_positive = [&](Index t) {
    return orient2(uv[corner_vertex[3 * t]], uv[corner_vertex[3 * t + 1]], uv[corner_vertex[3 * t + 2]]) <= 0;
  };
  for (const Index t : select(exec, static_cast<Index>(corner_vertex.size() / 3), is_not_positive))
    once[topology.triangle_component[t]] = 0;
  for (Index k = 0; k < topology.num_components; ++k)
    once[k] = once[k] && boundaries.has_one_outer_loop(k) && is_simple(exec, boundaries.edges(k));
  return once;
}

bool covers_once(const Exec& exec, In<Index> corner_vertex, const Topology& topology, In<Vec2> uv) {
  const std::vector<std::uint8_t> once = components_covering_once(exec, corner_vertex, topology, uv);
  if (!std::all_of(once.begin(), once.end(), [](std::uint8_t c) { return c; })) return false;
  if (topology.num_components < 2) return true;
  const Boundaries boundaries(corner_vertex, topology, uv);
  std::vector<Box2> box;
  for (Index k = 0; k < topology.num_components; ++k) box.push_back(box_of(boundaries.edges(k)));
  return are_apart(exec, box);
}

}  // namespace planish
