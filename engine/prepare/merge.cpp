#include "engine/prepare/merge.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace planish {
namespace {

bool finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// place [V] the first used vertex at the position of each; a vertex of its own for unused and non-finite
/// ones.
std::vector<Index> places(const Soup& soup) {
  std::vector<Index> used = soup.corner_vertex;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::erase_if(used, [&](Index v) { return !finite(soup.position[v]); });
  const auto key = [&](Index v) {
    const Vec3& p = soup.position[v];
    return std::tie(p.x, p.y, p.z);
  };
  std::stable_sort(used.begin(), used.end(), [&](Index v, Index w) { return key(v) < key(w); });
  std::vector<Index> place(soup.position.size());
  for (Index v = 0; v < static_cast<Index>(place.size()); ++v) place[v] = v;
  for (std::size_t i = 1; i < used.size(); ++i) {
    if (key(used[i]) == key(used[i - 1])) place[used[i]] = place[used[i - 1]];
  }
  return place;
}

class Merge {
 public:
  Merge(const Soup& soup, std::vector<Index> place)
      : soup_(soup),
        place_(std::move(place)),
        barred_(place_.size(), 0),
        crowded_(place_.size(), 0),
        same_(static_cast<Index>(place_.size())) {
    corner_place_.reserve(soup.corner_vertex.size());
    for (Index v : soup.corner_vertex) corner_place_.push_back(place_[v]);
    sides_ = sorted_sides(corner_place_);
  }

  /// Unites, and once more without the places where that gave an edge a third triangle. Fewer unions cannot
  /// give another edge one.
  void run() {
    unite();
    if (bar_crowded_edges()) {
      same_ = Unions(static_cast<Index>(place_.size()));
      unite();
    }
  }

  Index vertex(Index v) { return same_.root(v); }

  /// Whether the vertices at v's place were kept apart for a reason.
  bool kept_apart(Index v) const { return barred_[place_[v]] || crowded_[place_[v]]; }

 private:
  void unite_at_one_place(Index v, Index w) {
    if (v != w && place_[v] == place_[w] && !barred_[place_[v]]) same_.unite(v, w);
  }

  Index start(const EdgeSide& side) const { return soup_.corner_vertex[side.corner]; }
  Index end(const EdgeSide& side) const { return soup_.corner_vertex[next_corner(side.corner)]; }

  void unite() {
    for_each_edge(sides_, [&](In<EdgeSide> edge) {
      const std::size_t open = open_sides(edge), sheets = num_apexes(edge, corner_place_);
      if (open == edge.size() && sheets == 2) {
        for (const EdgeSide& side : edge.subspan(1))
          stitch(edge[0], side);  // more than two: copies among them
      } else if (open >= 2 && sheets > 2) {
        crowded_[edge[0].low] = crowded_[edge[0].high] = 1;
      }
    });
    for (Index c = 0; c < static_cast<Index>(corner_place_.size()); ++c) {  // edges without length
      unite_at_one_place(soup_.corner_vertex[c], soup_.corner_vertex[next_corner(c)]);
    }
  }

  void stitch(const EdgeSide& a, const EdgeSide& b) {
    const bool along = place_[start(a)] == place_[start(b)];
    unite_at_one_place(start(a), along ? start(b) : end(b));
    unite_at_one_place(end(a), along ? end(b) : start(b));
  }

  bool same_ends(const EdgeSide& a, const EdgeSide& b) const {
    return std::minmax(start(a), end(a)) == std::minmax(start(b), end(b));
  }

  /// Sides that share their two vertices with no other side.
  std::size_t open_sides(In<EdgeSide> edge) const {
    std::vector<std::pair<Index, Index>> ends;
    for (const EdgeSide& side : edge) {
      ends.emplace_back(std::min(start(side), end(side)), std::max(start(side), end(side)));
    }
    std::sort(ends.begin(), ends.end());
    std::size_t open = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      open += (i == 0 || ends[i] != ends[i - 1]) && (i + 1 == ends.size() || ends[i] != ends[i + 1]);
    }
    return open;
  }

  /// Triangles on an edge, copies counted once: sheets that lie on one another are not two halves of one.
  static std::size_t num_apexes(In<EdgeSide> edge, In<Index> vertex_of_corner) {
    std::vector<Index> apexes;
    for (const EdgeSide& side : edge) apexes.push_back(vertex_of_corner[previous_corner(side.corner)]);
    std::sort(apexes.begin(), apexes.end());
    return static_cast<std::size_t>(std::unique(apexes.begin(), apexes.end()) - apexes.begin());
  }

  bool bar_crowded_edges() {
    std::vector<Index> united;
    united.reserve(soup_.corner_vertex.size());
    for (Index v : soup_.corner_vertex) united.push_back(same_.root(v));
    bool found = false;
    for_each_edge(sorted_sides(united), [&](In<EdgeSide> edge) {
      const bool joined = std::any_of(edge.begin(), edge.end(),
                                      [&](const EdgeSide& side) { return !same_ends(edge[0], side); });
      if (!joined || num_apexes(edge, united) < 3) return;
      barred_[place_[edge[0].low]] = barred_[place_[edge[0].high]] = 1;
      found = true;
    });
    return found;
  }

  const Soup& soup_;
  std::vector<Index> place_, corner_place_;
  std::vector<EdgeSide> sides_;
  std::vector<char> barred_, crowded_;
  Unions same_;
};

}  // namespace

void merge_vertices(Soup& soup, MendingLog& log) {
  std::vector<Index> place = places(soup);
  std::vector<Index> shared;  // used vertices at the position of an earlier one
  for (Index v = 0; v < static_cast<Index>(place.size()); ++v) {
    if (place[v] != v) shared.push_back(v);
  }
  if (shared.empty()) return;
  Merge merge(soup, std::move(place));
  merge.run();
  for (Index v : shared) {
    if (merge.vertex(v) != v) {
      log.add("merged vertices at equal positions", soup.vertex_origin[v]);
    } else if (merge.kept_apart(v)) {
      log.add("vertices at equal positions left apart: a third triangle would join an edge",
              soup.vertex_origin[v]);
    }
  }
  for (Index& v : soup.corner_vertex) v = merge.vertex(v);
}

}  // namespace planish
