#include "engine/solve/graph.hpp"

#include <algorithm>
#include <numeric>

namespace planish {
namespace {

constexpr Index kSmall = 3000;  // vertices: below, better groups are worth their cost

/// All vertices in an order that a seed gives.
std::vector<Index> visiting_order(Index n, std::uint64_t seed) {
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), 0);
  if (seed == 0) return order;
  std::uint64_t state = seed * 0x9E3779B97F4A7C15;  // xorshift (Marsaglia 2003)
  for (Index i = n - 1; i > 0; --i) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    std::swap(order[i], order[state % (static_cast<std::uint64_t>(i) + 1)]);
  }
  return order;
}

/// Neighbourhoods that do not touch, and what lies between them joined to the lightest beside it. Returns how many.
Index group_neighbourhoods(const Graph& graph, In<Index> order, Out<Index> group) {
  std::vector<Index> weight;
  const auto is_free = [&](Index v) {
    const In<Index> around = graph.neighbours(v);
    return group[v] == kNone &&
           std::all_of(around.begin(), around.end(), [&](Index u) { return group[u] == kNone; });
  };
  for (const Index v : order) {
    if (!is_free(v)) continue;
    group[v] = static_cast<Index>(weight.size());
    weight.push_back(graph.weight[v]);
    for (const Index u : graph.neighbours(v)) {
      group[u] = group[v];
      weight.back() += graph.weight[u];
    }
  }
  // What is left has a neighbour in a group, or it would have made one.
  for (const Index v : order) {
    if (group[v] != kNone) continue;
    Index lightest = kNone;
    for (const Index u : graph.neighbours(v)) {
      if (group[u] != kNone && (lightest == kNone || weight[group[u]] < weight[lightest]))
        lightest = group[u];
    }
    group[v] = lightest;
    weight[lightest] += graph.weight[v];
  }
  return static_cast<Index>(weight.size());
}

/// A vertex with up to two free neighbours along its heaviest edges, none of the groups much heavier than the others.
Index group_along_edges(const Graph& graph, In<Index> order, Out<Index> group) {
  constexpr Index kMembers = 3;
  const Offset total = std::accumulate(graph.weight.begin(), graph.weight.end(), Offset{0});
  const Offset most = std::max<Offset>(kMembers, kMembers * 3 * total / (2 * graph.size()));
  Index num_groups = 0;
  for (const Index v : order) {
    if (group[v] != kNone) continue;
    group[v] = num_groups++;
    Offset weight = graph.weight[v];
    for (Index members = 1; members < kMembers; ++members) {
      Index best = kNone;
      for (Index k = graph.begin[v]; k < graph.begin[v + 1]; ++k) {
        const Index u = graph.neighbour[k];
        if (group[u] != kNone || weight + graph.weight[u] > most) continue;
        const auto heaviness = [&](Index edge) {
          return graph.edge_weight.empty() ? 1 : graph.edge_weight[edge];
        };
        if (best == kNone || heaviness(k) > heaviness(best) ||
            (heaviness(k) == heaviness(best) && graph.weight[u] < graph.weight[graph.neighbour[best]]))
          best = k;
      }
      if (best == kNone) break;
      group[graph.neighbour[best]] = group[v];
      weight += graph.weight[graph.neighbour[best]];
    }
  }
  return num_groups;
}

/// Vertices by group: those of group g are member[begin[g], begin[g + 1]).
void list_members(In<Index> group, Index num_groups, std::vector<Index>& begin, std::vector<Index>& member) {
  begin.assign(num_groups + 1, 0);
  for (const Index g : group) ++begin[g + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  member.resize(group.size());
  std::vector<Index> end(begin.begin(), begin.end() - 1);
  for (std::size_t v = 0; v < group.size(); ++v) member[end[group[v]]++] = static_cast<Index>(v);
}

}  // namespace

Graph coarsen(const Graph& graph, std::uint64_t seed, std::vector<Index>& group) {
  group.assign(graph.size(), kNone);
  const std::vector<Index> order = visiting_order(graph.size(), seed);
  const Index num_groups = graph.size() > kSmall ? group_neighbourhoods(graph, order, group)
                                                 : group_along_edges(graph, order, group);
  std::vector<Index> begin, member;
  list_members(group, num_groups, begin, member);
  Graph coarse;
  coarse.weight.assign(num_groups, 0);
  std::vector<Index> place(num_groups, kNone);  // of each group among the neighbours of the present one
  for (Index g = 0; g < num_groups; ++g) {
    for (Index i = begin[g]; i < begin[g + 1]; ++i) {
      const Index v = member[i];
      coarse.weight[g] += graph.weight[v];
      for (Index k = graph.begin[v]; k < graph.begin[v + 1]; ++k) {
        const Index other = group[graph.neighbour[k]],
                    edges = graph.edge_weight.empty() ? 1 : graph.edge_weight[k];
        if (other == g) continue;
        if (place[other] >= coarse.begin.back()) {
          coarse.edge_weight[place[other]] += edges;
        } else {
          place[other] = static_cast<Index>(coarse.neighbour.size());
          coarse.neighbour.push_back(other);
          coarse.edge_weight.push_back(edges);
        }
      }
    }
    coarse.begin.push_back(static_cast<Index>(coarse.neighbour.size()));
  }
  return coarse;
}

Graph part_of(const Graph& graph, In<std::uint8_t> part, std::uint8_t which, std::vector<Index>& local,
              std::vector<Index>& vertex) {
  Graph result;
  vertex.clear();
  for (Index v = 0; v < graph.size(); ++v) {
    if (part[v] != which) continue;
    local[v] = static_cast<Index>(vertex.size());
    vertex.push_back(v);
  }
  result.begin.reserve(vertex.size() + 1);
  result.weight.reserve(vertex.size());
  for (const Index v : vertex) {
    result.weight.push_back(graph.weight[v]);
    for (const Index u : graph.neighbours(v)) {
      if (part[u] == which) result.neighbour.push_back(local[u]);
    }
    result.begin.push_back(static_cast<Index>(result.neighbour.size()));
  }
  return result;
}

}  // namespace planish
