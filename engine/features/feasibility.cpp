#include "engine/features/feasibility.hpp"

#include <algorithm>

namespace planish {
namespace {

class Freeing {
 public:
  Freeing(RefinedMesh& mesh, const std::vector<PrescribedChain>& chains)
      : mesh_(mesh), first_(mesh.num_vertices() + 1, 0) {
    for (std::size_t k = 0; k < chains.size(); ++k) {
      for (const Index v : chains[k].vertex) on_.push_back({v, static_cast<Index>(k)});
      straight_.push_back(chains[k].straight);
    }
    std::sort(on_.begin(), on_.end(), [](const On& a, const On& b) {
      return a.vertex != b.vertex ? a.vertex < b.vertex : a.chain < b.chain;
    });
    for (const On& on : on_) ++first_[on.vertex + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  }

  Index operator()() {
    for (const On& on : on_) {
      if (first_[on.vertex] == &on - on_.data()) free_star(on.vertex);
    }
    return splits_;
  }

 private:
  struct On {
    Index vertex, chain;
  };

  bool prescribed(Index v) const {
    return v + 1 < static_cast<Index>(first_.size()) && first_[v] < first_[v + 1];
  }

  bool on_one_straight_chain(Index u, Index v) const {
    for (Index i = first_[u]; i < first_[u + 1]; ++i) {
      for (Index j = first_[v]; j < first_[v + 1]; ++j) {
        if (on_[i].chain == on_[j].chain && straight_[on_[i].chain]) return true;
      }
    }
    return false;
  }

  void free_star(Index v) {
    // A split changes the star: begin again until nothing is left to split.
    while (true) {
      Index edge = kNone;
      mesh_.visit_star(v, [&](Index c) {
        edge = edge_to_split(c);
        return edge != kNone;
      });
      if (edge == kNone) return;
      const Index before = mesh_.num_vertices();
      mesh_.split_edge(edge, 0.5, 0);
      if (mesh_.num_vertices() == before) return;  // shorter than numbers can halve
      ++splits_;
    }
  }

  /// An edge of the triangle at corner c that has to be split, or kNone.
  Index edge_to_split(Index c) const {
    bool all_prescribed = true;
    Index longest = kNone;
    double length = -1;
    for (const Index e : {c, next_corner(c), previous_corner(c)}) {
      const Index u = mesh_.vertex(e), w = mesh_.vertex(next_corner(e));
      all_prescribed = all_prescribed && prescribed(u);
      if (mesh_.is_constrained(e) || !prescribed(u) || !prescribed(w)) continue;
      if (on_one_straight_chain(u, w)) return e;
      const double l = norm(mesh_.position(w) - mesh_.position(u));
      if (l > length) longest = e, length = l;
    }
    return all_prescribed ? longest : kNone;
  }

  RefinedMesh& mesh_;
  std::vector<On> on_;  // sorted by vertex
  std::vector<Index> first_;
  std::vector<bool> straight_;
  Index splits_ = 0;
};

}  // namespace

Index free_prescribed_triangles(RefinedMesh& mesh, const std::vector<PrescribedChain>& chains) {
  return Freeing(mesh, chains)();
}

}  // namespace planish
