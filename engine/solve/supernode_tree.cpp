#include "engine/solve/supernode_tree.hpp"

#include <algorithm>

#include "engine/solve/subtrees.hpp"
#include "kernels/base/offsets.hpp"

namespace planish {
namespace {

// Tasks of at most this share of the work: enough of them to keep many cores busy, few enough to add up
// cheaply.
constexpr double kSubtreeShare = 1.0 / 16, kLeastSubtree = 2e4;  // entries

Panel panel(const SupernodalFactor& f, Index s) {
  return {f.super[s + 1] - f.super[s], f.row_begin[s + 1] - f.row_begin[s], f.value + f.value_begin[s]};
}

FloatPanel rounded_panel(const SupernodalFactor& f, Index s) {
  return {f.super[s + 1] - f.super[s], f.row_begin[s + 1] - f.row_begin[s], f.rounded + f.value_begin[s]};
}

In<Index> rows_below(const SupernodalFactor& f, Index s) {
  return slice(f.row, {f.row_begin[s] + (f.super[s + 1] - f.super[s]), f.row_begin[s + 1]});
}

/// The panel's rows of the right-hand side, one array a coordinate.
struct PanelRows {
  explicit PanelRows(Index most_rows) : u(most_rows), v(most_rows) {}

  void set(Index i, Vec2 z) { u[i] = z.x, v[i] = z.y; }
  Vec2 get(Index i) const { return {u[i], v[i]}; }

  std::vector<double> u, v;
};

void load_columns(const SupernodalFactor& f, Index s, In<Vec2> y, PanelRows& rows) {
  for (Index j = f.super[s]; j < f.super[s + 1]; ++j) rows.set(j - f.super[s], y[j]);
}

void store_columns(const SupernodalFactor& f, Index s, const PanelRows& rows, Out<Vec2> y) {
  for (Index j = f.super[s]; j < f.super[s + 1]; ++j) y[j] = rows.get(j - f.super[s]);
}

/// Forward substitution of one supernode; add(row, update) receives what goes to the rows below.
template <class Add>
void forward_one(const SupernodalFactor& f, Index s, PanelRows& rows, Out<Vec2> y, Add add) {
  const Panel p = panel(f, s);
  load_columns(f, s, y, rows);
  for (Index i = p.columns; i < p.rows; ++i) rows.set(i, {});
  if (f.rounded) {
    f.solves->forward_single(rounded_panel(f, s), rows.u.data(), rows.v.data());
  } else {
    f.solves->forward(p, rows.u.data(), rows.v.data());
  }
  store_columns(f, s, rows, y);
  const In<Index> below = rows_below(f, s);
  for (Index i = p.columns; i < p.rows; ++i) add(below[i - p.columns], rows.get(i));
}

void backward_one(const SupernodalFactor& f, Index s, PanelRows& rows, Out<Vec2> y) {
  const Panel p = panel(f, s);
  load_columns(f, s, y, rows);
  const In<Index> below = rows_below(f, s);
  for (Index i = p.columns; i < p.rows; ++i) rows.set(i, y[below[i - p.columns]]);
  if (f.rounded) {
    f.solves->backward_single(rounded_panel(f, s), rows.u.data(), rows.v.data());
  } else {
    f.solves->backward(p, rows.u.data(), rows.v.data());
  }
  store_columns(f, s, rows, y);
}

/// Parent of each supernode: the one that holds its first row below; kNone at roots.
std::vector<Index> supernode_parents(const SupernodalFactor& f) {
  std::vector<Index> supernode_of(f.super.back());
  for (Index s = 0; s < f.num_supernodes(); ++s) {
    std::fill(supernode_of.begin() + f.super[s], supernode_of.begin() + f.super[s + 1], s);
  }
  std::vector<Index> parent(f.num_supernodes(), kNone);
  for (Index s = 0; s < f.num_supernodes(); ++s) {
    const In<Index> below = rows_below(f, s);
    if (!below.empty()) parent[s] = supernode_of[below.front()];
  }
  return parent;
}

}  // namespace

SupernodeTree::SupernodeTree(const SupernodalFactor& f) {
  const Index n = f.num_supernodes();
  parent_ = supernode_parents(f);
  std::vector<double> work(n);
  for (Index s = 0; s < n; ++s) {
    const Panel p = panel(f, s);
    work[s] = static_cast<double>(p.columns) * p.rows;
    most_rows_ = std::max(most_rows_, p.rows);
  }
  Subtrees split = split_into_subtrees(parent_, work, kSubtreeShare, kLeastSubtree);
  subtree_ = std::move(split.subtree);
  top_ = std::move(split.top);
  top_place_.assign(f.super.back(), kNone);
  for (const Index s : top_) {
    for (Index j = f.super[s]; j < f.super[s + 1]; ++j) {
      top_place_[j] = static_cast<Index>(top_column_.size());
      top_column_.push_back(j);
    }
  }
}

void SupernodeTree::forward(const Exec& exec, const SupernodalFactor& f, Out<Vec2> y) const {
  const auto num_tasks = static_cast<Index>(subtree_.size());
  const std::size_t num_top = top_column_.size();
  std::vector<Vec2> top_update(num_top * num_tasks);  // each task's own sum for the columns above the tasks
  exec.for_tasks(num_tasks, [&](Index task) {
    const Out<Vec2> to_top = Out<Vec2>(top_update).subspan(task * num_top, num_top);
    PanelRows rows(most_rows_);
    for (Index s = subtree_[task].begin; s < subtree_[task].end; ++s) {
      forward_one(f, s, rows, y, [&](Index row, Vec2 update) {
        const Index place = top_place_[row];
        (place == kNone ? y[row] : to_top[place]) += update;
      });
    }
  });
  exec.for_blocks(static_cast<Index>(num_top), kBlock, [&](Index, Range r) {
    for (Index i = r.begin; i < r.end; ++i) {
      for (Index task = 0; task < num_tasks; ++task) y[top_column_[i]] += top_update[task * num_top + i];
    }
  });
  PanelRows rows(most_rows_);
  for (const Index s : top_) {
    forward_one(f, s, rows, y, [&](Index row, Vec2 update) { y[row] += update; });
  }
}

void SupernodeTree::backward(const Exec& exec, const SupernodalFactor& f, Out<Vec2> y) const {
  PanelRows rows(most_rows_);
  for (std::size_t k = top_.size(); k-- > 0;) backward_one(f, top_[k], rows, y);
  exec.for_tasks(static_cast<Index>(subtree_.size()), [&](Index task) {
    PanelRows own_rows(most_rows_);
    for (Index s = subtree_[task].end; s-- > subtree_[task].begin;) backward_one(f, s, own_rows, y);
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

SparseColumn SupernodeTree::forward(const SupernodalFactor& f, const SparseColumn& rhs, Out<Vec2> y) const {
  for (std::size_t i = 0; i < rhs.row.size(); ++i) y[rhs.row[i]] = rhs.value[i];
  const std::vector<Index> reached = reach(f, rhs.row);
  PanelRows rows(most_rows_);
  SparseColumn result;
  for (const Index s : reached) {
    forward_one(f, s, rows, y, [&](Index row, Vec2 update) { y[row] += update; });
    for (Index j = f.super[s]; j < f.super[s + 1]; ++j) {
      result.row.push_back(j);
      result.value.push_back(y[j]);
      y[j] = {};
    }
  }
  return result;
}

void SupernodeTree::solve(const Exec& exec, const SupernodalFactor& f, In<Vec2> rhs, Out<Vec2> x) const {
  const auto n = static_cast<Index>(f.permutation.size());
  std::vector<Vec2> y(n);
  exec.for_blocks(n, kBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) y[k] = rhs[f.permutation[k]];
  });
  forward(exec, f, y);
  backward(exec, f, y);
  exec.for_blocks(n, kBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) x[f.permutation[k]] = y[k];
  });
}

}  // namespace planish
