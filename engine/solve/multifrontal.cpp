#include "engine/solve/multifrontal.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>

#include "engine/exec/large_array.hpp"
#include "kernels/sparse/extend_add.hpp"

namespace planish {
namespace {

constexpr Index kBlockColumns = 64;  // of a panel, factored before what follows is updated
constexpr Index kStrip = 32;         // columns of a front that one task updates
constexpr Index kRowBlock = 192;     // rows of a panel that one task solves for

class Fronts {
 public:
  Fronts(const Exec& exec, const CholeskyAnalysis& analysis, const DenseKernels& kernels, In<double> value,
         double* panels)
      : exec_(exec),
        a_(analysis),
        kernels_(kernels),
        value_(value),
        panels_(panels),
        update_(analysis.num_supernodes(), nullptr),
        kept_(analysis.num_supernodes()),
        in_top_(analysis.num_supernodes(), 0),
        first_bad_(analysis.size()) {
    for (const Index s : a_.tasks.top) in_top_[s] = 1;
  }

  Index run() {
    exec_.for_tasks(static_cast<Index>(a_.tasks.subtree.size()),
                    [&](Index task) { factor_subtrees(a_.tasks.subtree[task]); });
    for (const std::vector<Index>& height : heights()) {
      if (first_bad_ < a_.size()) break;
      exec_.for_tasks(static_cast<Index>(height.size()), [&](Index i) { factor_shared(height[i]); });
    }
    return first_bad_ < a_.size() ? first_bad_.load() : kNone;
  }

 private:
  ColumnMajor panel(Index s) const { return {panels_ + a_.value_begin[s], a_.rows(s)}; }
  ColumnMajor update(Index s) const { return {update_[s], a_.below(s)}; }

  void report(Index column) {
    Index known = first_bad_;
    while (column < known && !first_bad_.compare_exchange_weak(known, column)) {
    }
  }

  /// Supernodes above the tasks by height: those of one height do not depend on one another.
  std::vector<std::vector<Index>> heights() const {
    std::vector<std::vector<Index>> result;
    std::vector<Index> height(a_.num_supernodes(), 0);
    for (const Index s : a_.tasks.top) {
      for (const Index c : a_.children(s)) height[s] = std::max(height[s], in_top_[c] ? height[c] + 1 : 0);
      if (height[s] == static_cast<Index>(result.size())) result.emplace_back();
      result[height[s]].push_back(s);
    }
    return result;
  }

  // ---- fronts of one task ----

  struct Stacks {
    std::vector<std::uint8_t> odd;  // of each supernode: which stack its products wait in
    std::array<Offset, 2> size{};
  };

  /// Products of a supernode wait while its siblings are worked on, in the stack that their descendants' do not use.
  Stacks plan(Range r) const {
    Stacks stacks;
    stacks.odd.resize(r.end - r.begin);
    for (Index s = r.end; s-- > r.begin;) {
      const Index parent = a_.parent[s];
      stacks.odd[s - r.begin] = parent != kNone && parent < r.end ? !stacks.odd[parent - r.begin] : 0;
    }
    std::array<Offset, 2> top{};
    for (Index s = r.begin; s < r.end; ++s) {
      const int own = stacks.odd[s - r.begin];
      if (waits_in_task(s)) top[own] += square(s);
      stacks.size[own] = std::max(stacks.size[own], top[own]);
      for (const Index c : a_.children(s)) top[!own] -= square(c);
    }
    return stacks;
  }

  bool waits_in_task(Index s) const { return a_.below(s) > 0 && !in_top_[a_.parent[s]]; }
  Offset square(Index s) const { return static_cast<Offset>(a_.below(s)) * a_.below(s); }

  void factor_subtrees(Range r) {
    const Stacks stacks = plan(r);
    LargeArray<double> memory(stacks.size[0] + stacks.size[1]);
    std::array<double*, 2> top = {memory.data(), memory.data() + stacks.size[0]};
    for (Index s = r.begin; s < r.end; ++s) {
      if (first_bad_ < a_.super[s]) return;  // an earlier pivot is bad already, which is the one to be named
      const int own = stacks.odd[s - r.begin];
      if (waits_in_task(s)) {
        update_[s] = top[own];
        top[own] += square(s);
      } else {
        keep_update(s);
      }
      if (!factor_alone(s)) return;
      for (const Index c : a_.children(s)) top[!own] -= square(c);
    }
  }

  /// Memory of its own for the products of s, until its parent has taken them in.
  void keep_update(Index s) {
    if (a_.below(s) == 0) return;
    kept_[s] = LargeArray<double>(square(s));
    update_[s] = kept_[s].data();
  }

  bool factor_alone(Index s) {
    const ColumnMajor p = panel(s);
    const Index columns = a_.columns(s), rows = a_.rows(s), below = rows - columns;
    std::fill_n(p.value, static_cast<Offset>(columns) * rows, 0.0);
    add_entries(s);
    for (const Index c : a_.children(s))
      extend_add(p, 0, a_.relative_rows(c), update(c), {0, columns_in_panel(c)});
    for (Index j = 0; j < columns; j += kBlockColumns) {
      const Index end = std::min(columns, j + kBlockColumns);
      const Index bad = kernels_.factor_columns(p, j, end, rows);
      if (bad != kNone) return report(a_.super[s] + bad), false;
      if (end < columns) subtract_block(p, j, end, {end, columns}, rows);
    }
    if (below == 0) return true;
    const ColumnMajor left{p.at(columns, 0), p.stride};
    kernels_.subtract_products(update(s), left, left, below, below, columns, true, true);
    for (const Index c : a_.children(s))
      extend_add(update(s), columns, a_.relative_rows(c), update(c), {columns_in_panel(c), a_.below(c)});
    return true;
  }

  /// Entries of A are the first to arrive, in a clear panel.
  void add_entries(Index s) {
    double* const p = panel(s).value;
    for (Index e = a_.entry_begin[s]; e < a_.entry_begin[s + 1]; ++e)
      p[a_.entry_place[e]] = value_[a_.entry_source[e]];
  }

  /// How many columns of the child's products belong to its parent's panel.
  Index columns_in_panel(Index child) const {
    const In<Index> place = a_.relative_rows(child);
    return static_cast<Index>(std::lower_bound(place.begin(), place.end(), a_.columns(a_.parent[child])) -
                              place.begin());
  }

  /// Columns r of a panel after those of [first, last) are factored.
  void subtract_block(ColumnMajor p, Index first, Index last, Range r, Index rows) const {
    const ColumnMajor factored{p.at(r.begin, first), p.stride};
    kernels_.subtract_products({p.at(r.begin, r.begin), p.stride}, factored, factored, rows - r.begin,
                               r.end - r.begin, last - first, false, true);
  }

  // ---- fronts that tasks share ----

  void factor_shared(Index s) {
    const ColumnMajor p = panel(s);
    const Index columns = a_.columns(s);
    exec_.for_blocks(columns, kStrip, [&](Index, Range r) {
      std::fill_n(p.at(0, r.begin), static_cast<Offset>(r.end - r.begin) * p.stride, 0.0);
    });
    add_entries(s);
    for (const Index c : a_.children(s)) {
      exec_.for_blocks(columns_in_panel(c), kStrip,
                       [&](Index, Range r) { extend_add(p, 0, a_.relative_rows(c), update(c), r); });
    }
    if (!factor_panel_shared(s)) return;
    keep_update(s);
    exec_.for_blocks(a_.below(s), kStrip, [&](Index, Range r) { fill_update(s, r); });
    for (const Index c : a_.children(s)) kept_[c] = {};
  }

  bool factor_panel_shared(Index s) {
    const ColumnMajor p = panel(s);
    const Index columns = a_.columns(s), rows = a_.rows(s);
    for (Index j = 0; j < columns; j += kBlockColumns) {
      const Index end = std::min(columns, j + kBlockColumns);
      const Index bad = kernels_.factor_columns(p, j, end, end);
      if (bad != kNone) return report(a_.super[s] + bad), false;
      exec_.for_blocks(rows - end, kRowBlock, [&](Index, Range r) {
        kernels_.solve_rows(p, j, end, {end + r.begin, end + r.end});
      });
      exec_.for_blocks(columns - end, kStrip, [&](Index, Range r) {
        subtract_block(p, j, end, {end + r.begin, end + r.end}, rows);
      });
    }
    return true;
  }

  /// Columns r of the products that s leaves, its children's added.
  void fill_update(Index s, Range r) {
    const ColumnMajor p = panel(s), u = update(s);
    const Index columns = a_.columns(s);
    const ColumnMajor left{p.at(columns + r.begin, 0), p.stride};
    kernels_.subtract_products({u.at(r.begin, r.begin), u.stride}, left, left, a_.below(s) - r.begin,
                               r.end - r.begin, columns, true, true);
    for (const Index c : a_.children(s)) {
      const In<Index> place = a_.relative_rows(c);
      const auto at = [&](Index row) {
        return static_cast<Index>(std::lower_bound(place.begin(), place.end(), columns + row) -
                                  place.begin());
      };
      extend_add(u, columns, place, update(c), {at(r.begin), at(r.end)});
    }
  }

  const Exec& exec_;
  const CholeskyAnalysis& a_;
  const DenseKernels& kernels_;
  In<double> value_;
  double* panels_;
  std::vector<double*> update_;           // products of each supernode, while they wait
  std::vector<LargeArray<double>> kept_;  // of those that wait for the fronts above the tasks
  std::vector<std::uint8_t> in_top_;
  std::atomic<Index> first_bad_;
};

}  // namespace

Index factor_fronts(const Exec& exec, const CholeskyAnalysis& analysis, const DenseKernels& kernels,
                    In<double> value, double* panels) {
  return Fronts(exec, analysis, kernels, value, panels).run();
}

}  // namespace planish
