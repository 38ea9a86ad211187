// One component of a surface as a graph in which each boundary loop is a single node, and the columns that
// cutting it works on.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "engine/prepare/topology.hpp"

namespace planish {

/// The part of a surface that is cut at once.
struct CutComponent {
  In<Index> triangle, vertex;
  Index loops = 0, genus = 0;
  bool needs_cut() const { return genus > 0 || loops == 0; }
};

/// Columns of the whole mesh; each component reads and writes its own part.
struct CutColumns {
  std::vector<double> length, cost;  ///< [3 T] of half-edges, mesh units
  std::vector<Index> hole;           ///< [V] boundary loop or kNone
  std::vector<double> distance;      ///< [V] from the root, or across the opened surface
  std::vector<double> nearest_root;  ///< [V] distance from the nearest root so far
  std::vector<Index> arrival;        ///< [V] half-edge by which the shortest path comes in, kNone at a root
  std::vector<Index> degree;         ///< [V] cut half-edges that leave the node
  std::vector<Index> parent;         ///< [T] of the disjoint sets of triangles
  std::vector<std::uint8_t> cut;     ///< [3 T] 1: cut, 2: cut and on an arc already traced
  std::vector<std::uint8_t> side;    ///< [3 T] side of the annulus that the corner lies on, 0: neither
};

/// Nodes are vertices; a boundary loop is one node, known by its first vertex. Keeps references.
class HoleGraph {
 public:
  /// hole [V] boundary loop or kNone
  HoleGraph(const Surface& surface, const Topology& topology, In<Index> hole)
      : surface_(surface), topology_(topology), hole_(hole) {}

  Index start(Index c) const { return surface_.corner_vertex[c]; }
  Index end(Index c) const { return surface_.corner_vertex[next_corner(c)]; }
  Index twin(Index c) const { return topology_.corner_twin[c]; }
  bool is_hole(Index node) const { return hole_[node] != kNone; }
  Index node(Index v) const {
    return is_hole(v) ? start(topology_.loop_corner[topology_.loop_begin[hole_[v]]]) : v;
  }

  /// body(half-edge) for the interior half-edges that leave a node.
  template <class Body>
  void for_each_spoke(Index node, Body&& body) const {
    const auto around = [&](Index v) {
      for (Index k = topology_.star_begin[v]; k < topology_.star_begin[v + 1]; ++k) {
        if (const Index c = topology_.star_corner[k]; twin(c) != kNone) body(c);
      }
    };
    if (!is_hole(node)) return around(node);
    const Range loop = topology_.loops().group(hole_[node]);
    for (Index k = loop.begin; k < loop.end; ++k) around(start(topology_.loop_corner[k]));
  }

 private:
  const Surface& surface_;
  const Topology& topology_;
  In<Index> hole_;
};

/// Nodes reached by a search, the nearest first (ties: the smaller node).
class NodeQueue {
 public:
  using Step = std::pair<double, Index>;  ///< distance of a node

  bool empty() const { return heap_.empty(); }

  void push(double distance, Index node) {
    heap_.emplace_back(distance, node);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  }

  Step pop() {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    const Step step = heap_.back();
    heap_.pop_back();
    return step;
  }

 private:
  std::vector<Step> heap_;
};

}  // namespace planish
