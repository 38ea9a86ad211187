// Shortest paths along edges.
#pragma once

#include <vector>

#include "engine/model/mesh.hpp"
#include "engine/prepare/topology.hpp"

namespace planish {

/// Searches between pairs of vertices; arrays are sized once, and each search pays for what it touches only.
class ShortestPaths {
 public:
  ShortestPaths(const Surface& surface, const Topology& topology);

  /// The vertices after `from` up to and with `to` of a path of least total edge length that passes no barred
  /// vertex in between (barred [V], or empty: none); empty where there is no such path. Of paths of the same
  /// length, one that depends on the numbers of the vertices only.
  /// Pre: from != to.   Cost: O(n log n) in the n vertices nearer than `to`, fewer by the straight distance
  /// that is left.   Ref: Hart, Nilsson and Raphael 1968 (A*).
  std::vector<Index> find(Index from, Index to, In<std::uint8_t> barred);

 private:
  struct Open {
    double estimate;  ///< length so far plus straight distance to the goal
    double length;    ///< length so far, to tell outdated entries
    Index vertex;
  };
  /// The cheapest first in a heap.
  static bool later(const Open& a, const Open& b) {
    return a.estimate != b.estimate ? a.estimate > b.estimate : a.vertex > b.vertex;
  }
  void reach(Index v, Index from, double length, Vec3 goal);
  bool search(Index from, Index to, In<std::uint8_t> barred);
  void forget();

  const Surface& surface_;
  const Topology& topology_;
  std::vector<double> length_;    ///< [V] shortest known, mesh units
  std::vector<Index> came_from_;  ///< [V]
  std::vector<Index> touched_;
  std::vector<Open> open_;
};

}  // namespace planish
