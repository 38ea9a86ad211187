#include "engine/prepare/cut_edges.hpp"

namespace planish {

void CutEdges::set_cut(Index c, bool cut) {
  m_.cut[c] = m_.cut[graph_.twin(c)] = cut;
  const Index by = cut ? 1 : -1;
  m_.degree[graph_.node(graph_.start(c))] += by, m_.degree[graph_.node(graph_.end(c))] += by;
}

void CutEdges::add(Index c) {
  set_cut(c, true);
  edges_.push_back(c);
}

void CutEdges::drop_uncut() {
  std::erase_if(edges_, [&](Index c) { return !m_.cut[c]; });
}

void CutEdges::clear() {
  for (Index c : edges_) set_cut(c, false);
  edges_.clear();
}

void CutEdges::prune() {
  std::vector<Index> tips;
  for (Index c : edges_) {
    for (Index v : {graph_.node(graph_.start(c)), graph_.node(graph_.end(c))}) {
      if (m_.degree[v] == 1) tips.push_back(v);
    }
  }
  while (!tips.empty()) {
    const Index tip = tips.back();
    tips.pop_back();
    if (m_.degree[tip] != 1) continue;
    const Index c = cut_spoke(tip, 1);
    set_cut(c, false);
    if (const Index v = graph_.node(graph_.end(c)); m_.degree[v] == 1) tips.push_back(v);
  }
  drop_uncut();
}

/// A half-edge with this mark that leaves the node, or kNone.
Index CutEdges::cut_spoke(Index node, std::uint8_t mark) const {
  Index found = kNone;
  graph_.for_each_spoke(node, [&](Index c) {
    if (m_.cut[c] == mark) found = c;
  });
  return found;
}

std::vector<CutEdges::Arc> CutEdges::arcs() {
  std::vector<Arc> arcs;
  for (Index e : edges_) {
    for (Index c : {e, graph_.twin(e)}) {
      if (m_.cut[c] == 1 && ends_arcs(graph_.node(graph_.start(c)))) arcs.push_back(trace_arc(c));
    }
  }
  for (Index c : edges_) m_.cut[c] = m_.cut[graph_.twin(c)] = 1;
  std::stable_sort(arcs.begin(), arcs.end(), [](const Arc& a, const Arc& b) { return a.cost > b.cost; });
  return arcs;
}

/// The arc that begins with a half-edge; its edges are marked as traced.
CutEdges::Arc CutEdges::trace_arc(Index first) {
  Arc arc;
  for (Index c = first; c != kNone;) {
    arc.corner.push_back(c);
    arc.cost += m_.cost[c];
    m_.cut[c] = m_.cut[graph_.twin(c)] = 2;
    const Index v = graph_.node(graph_.end(c));
    c = ends_arcs(v) ? kNone : cut_spoke(v, 1);
  }
  return arc;
}

bool CutEdges::is_intact(const Arc& arc) const {
  for (std::size_t k = 0; k < arc.corner.size(); ++k) {
    if (!m_.cut[arc.corner[k]]) return false;
    if (k > 0 && ends_arcs(graph_.node(graph_.start(arc.corner[k])))) return false;
  }
  return true;
}

}  // namespace planish
