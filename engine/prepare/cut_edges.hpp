// The edges of a cut while it is made: marked, pruned, and taken apart into arcs.
#pragma once

#include <vector>

#include "engine/prepare/hole_graph.hpp"

namespace planish {

/// Edges of one component that are cut, as a graph on the nodes of a HoleGraph. The marks are columns (cut,
/// degree), so that a search can ask for them; the list holds each edge once.
class CutEdges {
 public:
  /// A path of cut edges between two nodes that branch, end or are holes.
  struct Arc {
    double cost = 0;
    std::vector<Index> corner;  ///< half-edges in order
  };

  /// Keeps references. Pre: the component's part of columns.cut and columns.degree is 0.
  CutEdges(const HoleGraph& graph, CutColumns& columns) : graph_(graph), m_(columns) {}

  /// A half-edge each. Those whose mark was taken by set_cut() stay until drop_uncut().
  const std::vector<Index>& list() const { return edges_; }
  bool is_cut(Index c) const { return m_.cut[c] != 0; }

  /// Marks both half-edges of an edge.
  void set_cut(Index c, bool cut);
  void add(Index c);
  void drop_uncut();
  void clear();

  /// Removes dangling branches: edges at nodes with no other.
  void prune();

  /// The graph's arcs, the costliest first.
  std::vector<Arc> arcs();

  /// Whether an arc is still one after others were replaced.
  bool is_intact(const Arc& arc) const;

 private:
  Index cut_spoke(Index node, std::uint8_t mark) const;
  bool ends_arcs(Index node) const { return m_.degree[node] != 2 || graph_.is_hole(node); }
  Arc trace_arc(Index first);

  const HoleGraph& graph_;
  CutColumns& m_;
  std::vector<Index> edges_;
};

}  // namespace planish
