#include "engine/solve/star_blocks.hpp"

#include <algorithm>

namespace planish {
namespace {

/// Vertices of one block, each found at the first corner of its star.
struct Part {
  std::vector<Index> inner, shared;
};

class Blocks {
 public:
  Blocks(const Exec& exec, In<Index> corner_vertex, Offsets stars, In<Index> star_corner, Index block)
      : exec_(exec), corner_vertex_(corner_vertex), stars_(stars), star_corner_(star_corner), block_(block) {}

  StarBlocks operator()() {
    const auto num_triangles = static_cast<Index>(corner_vertex_.size() / 3);
    parts_.resize(Exec::num_blocks(num_triangles, block_));
    exec_.for_blocks(num_triangles, block_, [&](Index b, Range r) { parts_[b] = part(b, r); });
    place_runs();
    exec_.for_tasks(static_cast<Index>(parts_.size()), [&](Index b) { fill(b); });
    keep_shared();
    return std::move(result_);
  }

 private:
  Index block_of(Index corner) const { return corner / 3 / block_; }
  Index degree(Index v) const { return stars_.begin[v + 1] - stars_.begin[v]; }
  In<Index> star(Index v) const { return slice(star_corner_, stars_.group(v)); }

  Part part(Index b, Range r) const {
    Part part;
    for (Index c = 3 * r.begin; c < 3 * r.end; ++c) {
      const Index v = corner_vertex_[c];
      const In<Index> around = star(v);
      if (around.front() != c) continue;
      const bool inner = std::all_of(around.begin(), around.end(), [&](Index k) { return block_of(k) == b; });
      (inner ? part.inner : part.shared).push_back(v);
    }
    std::stable_sort(part.inner.begin(), part.inner.end(),
                     [&](Index a, Index z) { return degree(a) < degree(z); });
    return part;
  }

  /// Runs of all blocks, and room for what is in them.
  void place_runs() {
    Index vertices = 0, slots = 0;
    result_.run_begin.assign(1, 0);
    for (const Part& part : parts_) {
      for (std::size_t i = 0; i < part.inner.size(); ++i) {
        const Index d = degree(part.inner[i]);
        if (i == 0 || result_.run.back().degree != d) result_.run.push_back({d, vertices, vertices, slots});
        result_.run.back().end = ++vertices;
        slots += d;
      }
      result_.run_begin.push_back(static_cast<Index>(result_.run.size()));
    }
    result_.inner.resize(vertices);
    result_.slot.resize(slots);
  }

  void fill(Index b) {
    const Index first_corner = 3 * block_ * b;
    auto from = parts_[b].inner.begin();
    for (const StarRun& run : result_.runs_of(b)) {
      Index at = run.slot_begin;
      for (Index i = run.begin; i < run.end; ++i) {
        result_.inner[i] = *from;
        for (const Index c : star(*from)) result_.slot[at++] = static_cast<std::uint16_t>(c - first_corner);
        ++from;
      }
    }
  }

  void keep_shared() {
    std::vector<Index> degrees, count(parts_.size(), 0);
    for (const Part& part : parts_) {
      for (const Index v : part.shared) {
        result_.shared.push_back(v);
        degrees.push_back(degree(v));
        for (const Index c : star(v)) ++count[block_of(c)];
      }
    }
    result_.kept_begin = exclusive_scan(degrees);
    result_.outward_begin = exclusive_scan(count);
    result_.outward.resize(result_.num_kept());
    result_.place.resize(result_.num_kept());
    std::vector<Index> next(result_.outward_begin.begin(), result_.outward_begin.end() - 1);
    Index kept = 0;
    for (const Index v : result_.shared) {
      for (const Index c : star(v)) {
        const Index at = next[block_of(c)]++;
        result_.outward[at] = c;
        result_.place[at] = kept++;
      }
    }
  }

  const Exec& exec_;
  In<Index> corner_vertex_;
  Offsets stars_;
  In<Index> star_corner_;
  Index block_;
  std::vector<Part> parts_;
  StarBlocks result_;
};

}  // namespace

StarBlocks star_blocks(const Exec& exec, In<Index> corner_vertex, Offsets stars, In<Index> star_corner,
                       Index block) {
  return Blocks(exec, corner_vertex, stars, star_corner, block)();
}

}  // namespace planish
