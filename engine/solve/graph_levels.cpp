#include "engine/solve/graph_levels.hpp"

namespace planish {
namespace {

/// Groups of the part's vertices, numbered anew in their old order; member [v] of the whole's finer graph.
struct Groups {
  std::vector<Index> group;   // of the part's finer graph
  std::vector<Index> member;  // the whole's group, by the part's
  std::vector<Index> local;   // the part's group, by the whole's; kNone outside
  std::vector<Index> weight;
};

Groups groups_of(const Graph& fine, In<Index> member, In<Index> group, Index num_groups) {
  Groups result;
  result.local.assign(num_groups, kNone);
  for (const Index v : member) result.local[group[v]] = 0;
  for (Index g = 0; g < num_groups; ++g) {
    if (result.local[g] == kNone) continue;
    result.local[g] = static_cast<Index>(result.member.size());
    result.member.push_back(g);
  }
  result.weight.assign(result.member.size(), 0);
  result.group.resize(member.size());
  for (std::size_t v = 0; v < member.size(); ++v) {
    result.group[v] = result.local[group[member[v]]];
    result.weight[result.group[v]] += fine.weight[v];
  }
  return result;
}

Graph induced(const Graph& whole, Groups& groups) {
  Graph graph;
  graph.weight = std::move(groups.weight);
  graph.begin.reserve(graph.weight.size() + 1);
  for (const Index g : groups.member) {
    for (Index k = whole.begin[g]; k < whole.begin[g + 1]; ++k) {
      const Index other = groups.local[whole.neighbour[k]];
      if (other == kNone) continue;
      graph.neighbour.push_back(other);
      graph.edge_weight.push_back(whole.edge_weight[k]);
    }
    graph.begin.push_back(static_cast<Index>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace

GraphLevels part_of(const GraphLevels& whole, In<std::uint8_t> part, std::uint8_t which,
                    std::vector<Index>& vertex) {
  GraphLevels result;
  std::vector<Index> local(part.size());
  result.graph.push_back(part_of(whole.graph[0], part, which, local, vertex));
  std::vector<Index> member = vertex;
  for (std::size_t l = 0; l + 1 < whole.graph.size(); ++l) {
    Groups groups = groups_of(result.graph[l], member, whole.group[l], whole.graph[l + 1].size());
    if (static_cast<Index>(groups.member.size()) <= kLeastLevel) break;
    result.graph.push_back(induced(whole.graph[l + 1], groups));
    result.group.push_back(std::move(groups.group));
    member = std::move(groups.member);
  }
  return result;
}

}  // namespace planish
