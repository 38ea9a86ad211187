#include "engine/solve/supernode_tree.hpp"

#include <algorithm>
#include <memory>

#include "engine/solve/subtrees.hpp"
#include "kernels/base/offsets.hpp"

namespace planish {
namespace {

// Tasks of at most this share of the work: enough of them to keep many cores busy, few enough to add up
// cheaply.
constexpr double kSubtreeShare = 1.0 / 16, kLeastSubtree = 2e4;  // entries

In<Index> rows_of(const SupernodalFactor& f, Index s) {
  return slice(f.row, {f.row_begin[s], f.row_begin[s + 1]});
}

/// The factor as it was computed.
struct WidePanels {
  using Point = Vec2;
  using Number = double;
  static Offset scratch_size(Index rows) { return Offset{2} * rows; }

  static Panel panel(const SupernodalFactor& f, Index s) {
    return {f.columns(s), f.rows(s), f.value + f.value_begin[s]};
  }

  /// Substitution of one supernode; `inside` of the rows below receive what the panel takes from them, the rest stays in scratch.
  static void forward(const SupernodalFactor& f, Index s, Index inside, Vec2* y, double* scratch) {
    const Panel p = panel(f, s);
    const In<Index> row = rows_of(f, s);
    double* u = scratch;
    double* v = scratch + p.rows;
    for (Index j = 0; j < p.columns; ++j) u[j] = y[row[j]].x, v[j] = y[row[j]].y;
    std::fill(u + p.columns, u + p.rows, 0.0);
    std::fill(v + p.columns, v + p.rows, 0.0);
    f.solves->forward(p, u, v);
    for (Index j = 0; j < p.columns; ++j) y[row[j]] = {u[j], v[j]};
    for (Index i = p.columns; i < p.columns + inside; ++i) y[row[i]] += {u[i], v[i]};
  }
  static Vec2 taken(const double* scratch, Index rows, Index i) { return {scratch[i], scratch[rows + i]}; }

  static void backward(const SupernodalFactor& f, Index s, Vec2* y, double* scratch) {
    const Panel p = panel(f, s);
    const In<Index> row = rows_of(f, s);
    double* u = scratch;
    double* v = scratch + p.rows;
    for (Index i = 0; i < p.rows; ++i) u[i] = y[row[i]].x, v[i] = y[row[i]].y;
    f.solves->backward(p, u, v);
    for (Index j = 0; j < p.columns; ++j) y[row[j]] = {u[j], v[j]};
  }
};

/// The rounded factor.
struct NarrowPanels {
  using Point = FloatVec2;
  using Number = float;
  static Offset scratch_size(Index rows) { return strip_scratch(rows); }

  static StripPanel panel(const SupernodalFactor& f, Index s) {
    return {f.columns(s), f.rows(s), f.strips.entry + f.strips.begin[s], f.strips.column.from(f.super[s])};
  }
  static void forward(const SupernodalFactor& f, Index s, Index inside, FloatVec2* y, float* scratch) {
    f.strips.solves->forward(panel(f, s), &f.row[f.row_begin[s]], inside, y, scratch);
  }
  static FloatVec2 taken(const float* scratch, Index, Index i) {
    return {scratch[2 * i], scratch[2 * i + 1]};
  }
  static void backward(const SupernodalFactor& f, Index s, FloatVec2* y, float* scratch) {
    f.strips.solves->backward(panel(f, s), &f.row[f.row_begin[s]], y, scratch);
  }
};

void add(Vec2& y, Vec2 update) { y += update; }
void add(FloatVec2& y, FloatVec2 update) { y.x += update.x, y.y += update.y; }
void set(Vec2& y, Vec2 z) { y = z; }
void set(FloatVec2& y, Vec2 z) { y = {static_cast<float>(z.x), static_cast<float>(z.y)}; }
Vec2 wide(Vec2 z) { return z; }
Vec2 wide(FloatVec2 z) { return {z.x, z.y}; }

/// Parent of each supernode: the one that holds its first row below; kNone at roots.
std::vector<Index> supernode_parents(const SupernodalFactor& f) {
  std::vector<Index> supernode_of(f.super.back());
  for (Index s = 0; s < f.num_supernodes(); ++s) {
    std::fill(supernode_of.begin() + f.super[s], supernode_of.begin() + f.super[s + 1], s);
  }
  std::vector<Index> parent(f.num_supernodes(), kNone);
  for (Index s = 0; s < f.num_supernodes(); ++s) {
    if (f.rows(s) > f.columns(s)) parent[s] = supernode_of[rows_of(f, s)[f.columns(s)]];
  }
  return parent;
}

/// Supernodes by their height among `top`, which is ascending.
std::vector<std::vector<Index>> by_height(In<Index> top, In<Index> parent) {
  std::vector<Index> height(parent.size());
  std::vector<std::vector<Index>> level;
  for (const Index s : top) {
    if (height[s] == static_cast<Index>(level.size())) level.emplace_back();
    level[height[s]].push_back(s);
    if (parent[s] != kNone) height[parent[s]] = std::max(height[parent[s]], height[s] + 1);
  }
  return level;
}

constexpr std::size_t kLine = 64;  // bytes

/// Numbers of one panel's scratch, whole cache lines.
template <class Panels>
std::size_t scratch_stride(Index rows) {
  constexpr std::size_t kNumbers = kLine / sizeof(typename Panels::Number);
  return (static_cast<std::size_t>(Panels::scratch_size(rows)) + kNumbers - 1) / kNumbers * kNumbers;
}

/// The first cache line in it; as many numbers as a line has are left over.
template <class Number>
Number* first_line(std::vector<Number>& room) {
  void* begin = room.data();
  std::size_t space = room.size() * sizeof(Number);
  return static_cast<Number*>(std::align(kLine, space - kLine, begin, space));
}

}  // namespace

SupernodeTree::SupernodeTree(const SupernodalFactor& f) {
  const Index n = f.num_supernodes();
  parent_ = supernode_parents(f);
  std::vector<double> work(n);
  for (Index s = 0; s < n; ++s) {
    work[s] = static_cast<double>(f.columns(s)) * f.rows(s);
    most_rows_ = std::max(most_rows_, f.rows(s));
  }
  Subtrees split = split_into_subtrees(parent_, work, kSubtreeShare, kLeastSubtree);
  subtree_ = std::move(split.subtree);
  top_level_ = by_height(split.top, parent_);
  most_at_once_ = static_cast<Index>(subtree_.size());
  for (const std::vector<Index>& level : top_level_)
    most_at_once_ = std::max(most_at_once_, static_cast<Index>(level.size()));
  top_place_.assign(f.super.back(), kNone);
  for (const Index s : split.top) {
    for (Index j = f.super[s]; j < f.super[s + 1]; ++j) {
      top_place_[j] = static_cast<Index>(top_column_.size());
      top_column_.push_back(j);
    }
  }
}

/// One solve, with either kind of panels.
template <class Panels>
class SupernodeTree::Solve {
 public:
  using Point = typename Panels::Point;
  using Number = typename Panels::Number;
  using Memory = SolveMemory<Point, Number>;

  Solve(const Exec& exec, const SupernodeTree& tree, const SupernodalFactor& factor, Memory& memory)
      : exec_(exec),
        tree_(tree),
        f_(factor),
        memory_(memory),
        stride_(scratch_stride<Panels>(tree.most_rows_)) {
    memory.y.resize(f_.permutation.size());
    memory.to_top.resize(tree.subtree_.size() * tree.top_column_.size());
    memory.scratch.resize(tree.most_at_once_ * stride_ + kLine / sizeof(Number));
    scratch_ = first_line(memory.scratch);
  }

  /// load(k): the right-hand side at place k.
  template <class Load>
  void load(Load&& load) {
    for_places([&](Index k) { set(memory_.y[k], load(k)); });
  }
  /// store(k, solution at place k)
  template <class Store>
  void store(Store&& store) {
    for_places([&](Index k) { store(k, wide(memory_.y[k])); });
  }

  void forward() {
    exec_.for_tasks(static_cast<Index>(tree_.subtree_.size()), [&](Index task) { forward_subtree(task); });
    add_to_top();
    for (const std::vector<Index>& level : tree_.top_level_) forward_level(level);
  }

  void backward() {
    for (std::size_t k = tree_.top_level_.size(); k-- > 0;) {
      const std::vector<Index>& level = tree_.top_level_[k];
      exec_.for_tasks(static_cast<Index>(level.size()),
                      [&](Index i) { Panels::backward(f_, level[i], memory_.y.data(), scratch(i)); });
    }
    exec_.for_tasks(static_cast<Index>(tree_.subtree_.size()), [&](Index task) {
      const Range subtree = tree_.subtree_[task];
      for (Index s = subtree.end; s-- > subtree.begin;)
        Panels::backward(f_, s, memory_.y.data(), scratch(task));
    });
  }

 private:
  /// Of one task.
  Number* scratch(Index task) const { return scratch_ + task * stride_; }

  template <class Body>
  void for_places(Body&& body) {
    exec_.for_blocks(static_cast<Index>(memory_.y.size()), kBlock, [&](Index, Range r) {
      for (Index k = r.begin; k < r.end; ++k) body(k);
    });
  }

  void forward_subtree(Index task) {
    const std::size_t num_top = tree_.top_column_.size();
    const Out<Point> to_top = Out<Point>(memory_.to_top).subspan(task * num_top, num_top);
    std::fill(to_top.begin(), to_top.end(), Point{});
    const Range subtree = tree_.subtree_[task];
    const Index end = f_.super[subtree.end];  // columns from here on are not of this task
    Number* const own = scratch(task);
    for (Index s = subtree.begin; s < subtree.end; ++s) {
      const In<Index> row = rows_of(f_, s);
      Index inside = f_.rows(s);
      while (row[inside - 1] >= end) --inside;
      Panels::forward(f_, s, inside - f_.columns(s), memory_.y.data(), own);
      for (Index i = inside; i < f_.rows(s); ++i)
        add(to_top[tree_.top_place_[row[i]]], Panels::taken(own, f_.rows(s), i));
    }
  }

  void add_to_top() {
    const auto num_top = static_cast<Index>(tree_.top_column_.size());
    exec_.for_blocks(num_top, kBlock, [&](Index, Range r) {
      for (std::size_t task = 0; task < tree_.subtree_.size(); ++task) {
        for (Index i = r.begin; i < r.end; ++i)
          add(memory_.y[tree_.top_column_[i]], memory_.to_top[task * num_top + i]);
      }
    });
  }

  /// All at once; what they take from rows above, which several may, one after the other.
  void forward_level(const std::vector<Index>& level) {
    const auto size = static_cast<Index>(level.size());
    exec_.for_tasks(size, [&](Index k) { Panels::forward(f_, level[k], 0, memory_.y.data(), scratch(k)); });
    for (Index k = 0; k < size; ++k) {
      const In<Index> row = rows_of(f_, level[k]);
      for (Index i = f_.columns(level[k]); i < f_.rows(level[k]); ++i)
        add(memory_.y[row[i]], Panels::taken(scratch(k), f_.rows(level[k]), i));
    }
  }

  const Exec& exec_;
  const SupernodeTree& tree_;
  const SupernodalFactor& f_;
  Memory& memory_;
  std::size_t stride_;
  Number* scratch_;
};

/// Calls body with a solve by the panels there are.
template <class Body>
void SupernodeTree::with_solve(const Exec& exec, const SupernodalFactor& f, Body&& body) {
  if (f.strips.entry) {
    wide_ = {};  // not needed until the next factor
    body(Solve<NarrowPanels>(exec, *this, f, narrow_));
  } else {
    body(Solve<WidePanels>(exec, *this, f, wide_));
  }
}

void SupernodeTree::solve(const Exec& exec, const SupernodalFactor& f, In<Vec2> rhs, Out<Vec2> x) {
  with_solve(exec, f, [&](auto solve) {
    solve.load([&](Index k) { return rhs[f.permutation[k]]; });
    solve.forward();
    solve.backward();
    solve.store([&](Index k, Vec2 z) { x[f.permutation[k]] = z; });
  });
}

void SupernodeTree::forward(const Exec& exec, const SupernodalFactor& f, In<Vec2> rhs, Out<Vec2> half) {
  with_solve(exec, f, [&](auto solve) {
    solve.load([&](Index k) { return rhs[f.permutation[k]]; });
    solve.forward();
    solve.store([&](Index k, Vec2 z) { half[k] = z; });
  });
}

void SupernodeTree::backward(const Exec& exec, const SupernodalFactor& f, In<Vec2> half, Out<Vec2> x) {
  with_solve(exec, f, [&](auto solve) {
    solve.load([&](Index k) { return half[k]; });
    solve.backward();
    solve.store([&](Index k, Vec2 z) { x[f.permutation[k]] = z; });
  });
}

/// The supernodes that hold the rows, and all above them, ascending.
std::vector<Index> SupernodeTree::reach(const SupernodalFactor& f, In<Index> row) const {
  std::vector<Index> reached;
  for (const Index r : row) {
    const auto holder = std::upper_bound(f.super.begin(), f.super.end(), r) - f.super.begin() - 1;
    reached.push_back(static_cast<Index>(holder));
  }
  std::sort(reached.begin(), reached.end());
  reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
  std::vector<Index> all = reached;
  for (const Index first : reached) {
    for (Index s = parent_[first]; s != kNone; s = parent_[s]) all.push_back(s);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// One after the other in one workspace, which is zeros in between.
template <class Panels>
std::vector<SparseColumn> SupernodeTree::forward_sparse(const SupernodalFactor& f,
                                                        In<SparseColumn> rhs) const {
  std::vector<typename Panels::Point> y(f.permutation.size());
  std::vector<typename Panels::Number> room(scratch_stride<Panels>(most_rows_) +
                                            kLine / sizeof(typename Panels::Number));
  typename Panels::Number* const scratch = first_line(room);
  std::vector<SparseColumn> result(rhs.size());
  for (std::size_t k = 0; k < rhs.size(); ++k) {
    for (std::size_t i = 0; i < rhs[k].row.size(); ++i) set(y[rhs[k].row[i]], rhs[k].value[i]);
    for (const Index s : reach(f, rhs[k].row)) {
      Panels::forward(f, s, f.rows(s) - f.columns(s), y.data(), scratch);
      for (Index j = f.super[s]; j < f.super[s + 1]; ++j) {
        result[k].row.push_back(j);
        result[k].value.push_back(wide(y[j]));
        y[j] = {};
      }
    }
  }
  return result;
}

std::vector<SparseColumn> SupernodeTree::forward(const SupernodalFactor& f, In<SparseColumn> rhs) const {
  return f.strips.entry ? forward_sparse<NarrowPanels>(f, rhs) : forward_sparse<WidePanels>(f, rhs);
}

}  // namespace planish
