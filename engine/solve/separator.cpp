#include "engine/solve/separator.hpp"

#include <algorithm>

namespace planish {
namespace {

constexpr double kMostOnSide = 0.6;
constexpr Index kCoarsest = 100;    // vertices of the graph that is split from nothing
constexpr Index kTrialSize = 3000;  // vertices of a coarse graph that is split several times
constexpr std::uint64_t kTrials = 5;
constexpr int kPasses = 2;
constexpr std::size_t kIdleMoves = 60;  // and half the separator, without a better one, before a pass ends

/// Weight of the separator, more where the sides are uneven; what both sides take together is what counts.
double cut_ratio(const Separator& s) {
  const auto w = [&](int k) { return static_cast<double>(s.weight[k]); };
  return w(2) / (std::max(1.0, w(0)) * std::max(1.0, w(1)));
}

/// A vertex that may leave the separator for a side, and what that would gain.
struct Move {
  Offset gain = 0;
  Index vertex = kNone;
  bool operator<(const Move& other) const {
    return gain != other.gain ? gain < other.gain : vertex > other.vertex;
  }
};

class Refinement {
 public:
  Refinement(const Graph& graph, Separator& separator)
      : graph_(graph), s_(separator), moved_(graph.size(), 0), beside_(graph.size()) {
    for (const Index w : graph.weight) total_ += w;
    for (Index v = 0; v < graph.size(); ++v) {
      if (s_.side[v] == kSeparator) members_.push_back(v);
    }
  }

  void run() {
    for (int k = 0; k < kPasses && pass(); ++k) {
    }
  }

 private:
  struct Step {
    Index vertex;
    std::uint8_t to;
    std::size_t pulled_end;  // of pulled_, the vertices that it drew in
  };

  Offset most() const { return static_cast<Offset>(kMostOnSide * static_cast<double>(total_)) + 1; }
  /// Lighter is better, then more even.
  std::pair<Offset, Offset> quality() const {
    const Offset excess = std::max<Offset>(0, std::max(s_.weight[0], s_.weight[1]) - most());
    return {s_.weight[2] + excess, std::abs(s_.weight[0] - s_.weight[1])};
  }

  void weigh_sides(Index v) {
    beside_[v] = {};
    for (const Index u : graph_.neighbours(v)) {
      if (s_.side[u] != kSeparator) beside_[v][s_.side[u]] += graph_.weight[u];
    }
  }
  Offset gain(Index v, int to) const { return graph_.weight[v] - beside_[v][1 - to]; }
  void offer(Index v) {
    for (int to : {0, 1}) push(v, to);
  }
  void offer_all() {
    for (int to : {0, 1}) {
      queue_[to].clear();
      for (const Index v : members_) queue_[to].push_back({gain(v, to), v});
      std::make_heap(queue_[to].begin(), queue_[to].end());
    }
  }
  void push(Index v, int to) {
    queue_[to].push_back({gain(v, to), v});
    std::push_heap(queue_[to].begin(), queue_[to].end());
  }

  /// The best move towards a side that still holds, left in its queue.
  const Move* best(int to) {
    std::vector<Move>& queue = queue_[to];
    while (!queue.empty()) {
      const Move& top = queue.front();
      if (s_.side[top.vertex] == kSeparator && !moved_[top.vertex] && top.gain == gain(top.vertex, to) &&
          (s_.weight[to] + graph_.weight[top.vertex] <= most() || s_.weight[to] < s_.weight[1 - to]))
        return &top;
      std::pop_heap(queue.begin(), queue.end());
      queue.pop_back();
    }
    return nullptr;
  }

  int choose() {
    const Move *a = best(0), *b = best(1);
    if (!a || !b) return a ? 0 : b ? 1 : kNone;
    if (a->gain != b->gain) return a->gain > b->gain ? 0 : 1;
    return s_.weight[0] <= s_.weight[1] ? 0 : 1;
  }

  void move(Index v, int to) {
    const auto side = static_cast<std::uint8_t>(to), other = static_cast<std::uint8_t>(1 - to);
    s_.side[v] = side;
    moved_[v] = 1;
    s_.weight[2] -= graph_.weight[v];
    s_.weight[to] += graph_.weight[v];
    for (const Index u : graph_.neighbours(v)) {
      if (s_.side[u] == kSeparator) {
        beside_[u][to] += graph_.weight[v];
        if (!moved_[u]) push(u, 1 - to);
      } else if (s_.side[u] == other) {
        pull(u, other);
      }
    }
    steps_.push_back({v, side, pulled_.size()});
  }

  void pull(Index u, std::uint8_t from) {
    s_.side[u] = kSeparator;
    s_.weight[2] += graph_.weight[u];
    s_.weight[from] -= graph_.weight[u];
    pulled_.push_back(u);
    members_.push_back(u);
    weigh_sides(u);
    for (const Index w : graph_.neighbours(u)) {
      if (s_.side[w] != kSeparator) continue;
      beside_[w][from] -= graph_.weight[u];
      if (!moved_[w]) push(w, 1 - from);
    }
    if (!moved_[u]) offer(u);
  }

  void undo(std::size_t kept) {
    while (steps_.size() > kept) {
      const Step step = steps_.back();
      steps_.pop_back();
      const std::size_t begin = steps_.empty() ? 0 : steps_.back().pulled_end;
      for (std::size_t k = begin; k < step.pulled_end; ++k) {
        s_.side[pulled_[k]] = static_cast<std::uint8_t>(1 - step.to);
        s_.weight[1 - step.to] += graph_.weight[pulled_[k]];
        s_.weight[2] -= graph_.weight[pulled_[k]];
      }
      pulled_.resize(begin);
      s_.side[step.vertex] = kSeparator;
      s_.weight[step.to] -= graph_.weight[step.vertex];
      s_.weight[2] += graph_.weight[step.vertex];
    }
  }

  /// Moves until none helps for a while, then goes back to the best place. True where that is better than before.
  bool pass() {
    steps_.clear();
    pulled_.clear();
    for (const Index v : members_) weigh_sides(v);
    offer_all();
    const auto before = quality();
    auto best_quality = before;
    std::size_t best_steps = 0;
    const std::size_t idle = kIdleMoves + members_.size() / 2;
    for (int to = choose(); to != kNone && steps_.size() < best_steps + idle; to = choose()) {
      move(queue_[to].front().vertex, to);
      if (quality() < best_quality) {
        best_quality = quality();
        best_steps = steps_.size();
      }
    }
    for (const Step& step : steps_) moved_[step.vertex] = 0;
    undo(best_steps);
    std::erase_if(members_, [&](Index v) { return s_.side[v] != kSeparator; });
    std::sort(members_.begin(), members_.end());
    members_.erase(std::unique(members_.begin(), members_.end()), members_.end());
    return best_quality < before;
  }

  const Graph& graph_;
  Separator& s_;
  Offset total_ = 0;
  std::vector<std::uint8_t> moved_;
  std::vector<std::array<Offset, 2>> beside_;  // weight of the neighbours on each side, of separator vertices
  std::vector<Index> members_, pulled_;
  std::vector<Step> steps_;
  std::array<std::vector<Move>, 2> queue_;
};

void weigh(const Graph& graph, Separator& s) {
  s.weight = {};
  for (Index v = 0; v < graph.size(); ++v) s.weight[s.side[v]] += graph.weight[v];
}

/// Side 0 grows from a vertex, breadth first, to half of the weight; its rim is the separator.
Separator grow(const Graph& graph, Index seed, Index& last) {
  const Index n = graph.size();
  Offset total = 0, grown = 0;
  for (const Index w : graph.weight) total += w;
  Separator s;
  s.side.assign(n, 1);
  std::vector<std::uint8_t> queued(n, 0);
  std::vector<Index> queue;
  Index next_seed = 0;
  for (std::size_t k = 0; 2 * grown < total; ++k) {
    if (k == queue.size()) {  // a component is used up
      while (k > 0 && queued[next_seed]) ++next_seed;
      const Index start = k == 0 ? seed : next_seed;
      queued[start] = 1;
      queue.push_back(start);
    }
    const Index v = last = queue[k];
    s.side[v] = 0;
    grown += graph.weight[v];
    for (const Index u : graph.neighbours(v)) {
      if (!queued[u]) queued[u] = 1, queue.push_back(u);
    }
  }
  for (Index v = 0; v < n; ++v) {
    if (s.side[v] != 0) continue;
    for (const Index u : graph.neighbours(v)) {
      if (s.side[u] == 1) s.side[v] = kSeparator;
    }
  }
  weigh(graph, s);
  return s;
}

Separator split(const Graph& graph) {
  constexpr int kSeeds = 3;
  Separator best;
  Index seed = 0;
  for (int k = 0; k < kSeeds; ++k) {
    // Every other one from where the last ended: the far side.
    Index last = 0;
    Separator s = grow(graph, seed, last);
    refine_separator(graph, s);
    if (best.side.empty() || cut_ratio(s) < cut_ratio(best)) best = std::move(s);
    seed = k % 2 == 0 ? last : static_cast<Index>((static_cast<Offset>(k) * graph.size()) / kSeeds);
  }
  return best;
}

Separator refined(const Graph& graph, In<Index> group, const Separator& coarse) {
  Separator s{std::vector<std::uint8_t>(graph.size()), coarse.weight};
  for (Index v = 0; v < graph.size(); ++v) s.side[v] = coarse.side[group[v]];
  refine_separator(graph, s);
  return s;
}

Separator find(const Graph& graph, std::uint64_t seed) {
  if (graph.size() <= kCoarsest) return split(graph);
  std::vector<Index> group;
  const Graph coarse = coarsen(graph, seed, group);
  if (coarse.size() > graph.size() / 10 * 9) return split(graph);
  Separator found = find(coarse, seed);
  const bool is_first_small = graph.size() > kTrialSize && coarse.size() <= kTrialSize;
  for (std::uint64_t trial = 1; is_first_small && trial < kTrials; ++trial) {
    Separator other = find(coarse, trial);
    if (cut_ratio(other) < cut_ratio(found)) found = std::move(other);
  }
  return refined(graph, group, found);
}

/// As find(), from coarser graphs that may be there already.
Separator find_on(GraphLevels& levels, std::size_t level) {
  if (levels.graph[level].size() <= kTrialSize) return find(levels.graph[level], 0);
  if (levels.graph.size() == level + 1) {
    levels.group.emplace_back();
    Graph coarse = coarsen(levels.graph[level], 0, levels.group.back());
    levels.graph.push_back(std::move(coarse));
  }
  const Index size = levels.graph[level].size(), coarse_size = levels.graph[level + 1].size();
  if (coarse_size > size / 10 * 9) return split(levels.graph[level]);
  Separator found = find_on(levels, level + 1);
  for (std::uint64_t trial = 1; coarse_size <= kTrialSize && trial < kTrials; ++trial) {
    Separator other = find(levels.graph[level + 1], trial);
    if (cut_ratio(other) < cut_ratio(found)) found = std::move(other);
  }
  return refined(levels.graph[level], levels.group[level], found);
}

}  // namespace

void refine_separator(const Graph& graph, Separator& separator) { Refinement(graph, separator).run(); }

Separator find_separator(const Graph& graph) { return find(graph, 0); }

Separator find_separator(GraphLevels& levels) { return find_on(levels, 0); }

}  // namespace planish
