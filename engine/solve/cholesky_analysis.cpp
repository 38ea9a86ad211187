#include "engine/solve/cholesky_analysis.hpp"

#include <algorithm>
#include <limits>
#include <new>

#include "engine/solve/supernode_search.hpp"
#include "engine/solve/twin_rows.hpp"

namespace planish {
namespace {

// Tasks of at most this share of the work: enough of them to keep many cores busy, few enough for the fronts above to be
// worth sharing.
constexpr double kTaskShare = 1.0 / 32, kLeastTask = 1e6;  // flops

/// With the rows beyond the given ones last: row eliminated k-th.
std::vector<Index> whole_order(In<Index> order, Index size) {
  std::vector<Index> whole(order.begin(), order.end());
  for (auto row = static_cast<Index>(order.size()); row < size; ++row) whole.push_back(row);
  return whole;
}

/// Neighbours of each row that are eliminated before it, by places in the order.
Lists earlier_neighbours(const SymmetricMatrix& matrix, In<Index> place) {
  const Index n = matrix.size();
  Lists lists;
  std::vector<Index> count(n, 0);
  const auto visit = [&](auto&& edge) {
    for (Index j = 0; j < n; ++j) {
      const Index at = place[j];
      for (Index k = matrix.column_begin[j] + 1; k < matrix.column_begin[j + 1]; ++k) {
        const Index other = place[matrix.row[k]];
        edge(std::min(at, other), std::max(at, other));
      }
    }
  };
  visit([&](Index, Index later) { ++count[later]; });
  lists.begin = exclusive_scan(count);
  lists.row.resize(lists.begin[n]);
  std::copy_n(lists.begin.begin(), n, count.begin());
  visit([&](Index earlier, Index later) { lists.row[count[later]++] = earlier; });
  return lists;
}

/// Rows of every panel, ascending: row i belongs to the supernodes on the ways from its entries of A up to its own.
///   earlier: of rows that stand for one or two;  begin: place of the first of them in the elimination
void fill_rows(const Lists& earlier, In<Index> begin, In<Index> supernode_of, CholeskyAnalysis& a) {
  const Index num = a.num_supernodes(), num_groups = static_cast<Index>(earlier.begin.size()) - 1;
  std::vector<Index> end(a.row_begin.begin(), a.row_begin.end() - 1), reached_by(num, kNone);
  a.row.resize(a.row_begin.back());
  std::vector<Index> at(a.size(), kNone);
  for (Index g = 0; g < num_groups; ++g) at[begin[g]] = g;
  Index width = 1;
  for (Index i = 0; i < a.size(); i += width) {
    width = i + 1 < a.size() && at[i + 1] == kNone ? 2 : 1;
    const auto reach = [&](Index s) {
      reached_by[s] = i;
      for (Index k = i; k < i + width; ++k) a.row[end[s]++] = k;
    };
    const Index own = supernode_of[i];
    reach(own);
    for (const Index g : slice(In<Index>(earlier.row), earlier.offsets().group(at[i]))) {
      for (Index s = supernode_of[begin[g]]; reached_by[s] != i; s = a.parent[s]) reach(s);
    }
  }
}

void list_children(CholeskyAnalysis& a) {
  const Index num = a.num_supernodes();
  std::vector<Index> count(num, 0);
  for (const Index p : a.parent) {
    if (p != kNone) ++count[p];
  }
  a.child_begin = exclusive_scan(count);
  a.child.resize(a.child_begin.back());
  std::copy_n(a.child_begin.begin(), num, count.begin());
  for (Index s = 0; s < num; ++s) {
    if (a.parent[s] != kNone) a.child[count[a.parent[s]]++] = s;
  }
}

/// Where the rows of children and the entries of A go in each panel.
void fill_places(const Exec& exec, const SymmetricMatrix& matrix, In<Index> place, In<Index> supernode_of,
                 CholeskyAnalysis& a) {
  const Index num = a.num_supernodes(), n = a.size();
  std::vector<Index> count(num, 0);
  const auto visit = [&](auto&& entry) {
    for (Index j = 0; j < n; ++j) {
      const Index at = place[j];
      for (Index k = matrix.column_begin[j]; k < matrix.column_begin[j + 1]; ++k) {
        const Index other = place[matrix.row[k]];
        entry(k, std::min(at, other), std::max(at, other));
      }
    }
  };
  visit([&](Index, Index column, Index) { ++count[supernode_of[column]]; });
  a.entry_begin = exclusive_scan(count);
  a.entry_source.resize(matrix.row.size());
  a.entry_place.resize(matrix.row.size());
  std::vector<Index> entry_row(matrix.row.size());
  std::copy_n(a.entry_begin.begin(), num, count.begin());
  visit([&](Index k, Index column, Index row) {
    const Index s = supernode_of[column], e = count[s]++;
    a.entry_source[e] = k;
    a.entry_place[e] = (column - a.super[s]) * a.rows(s);
    entry_row[e] = row;
  });
  a.relative.resize(a.row.size() - n);
  exec.for_blocks(num, kBlock, [&](Index, Range r) {
    for (Index s = r.begin; s < r.end; ++s) {
      const In<Index> rows = In<Index>(a.row).subspan(a.row_begin[s], a.rows(s));
      for (Index e = a.entry_begin[s]; e < a.entry_begin[s + 1]; ++e) {
        a.entry_place[e] +=
            static_cast<Index>(std::lower_bound(rows.begin(), rows.end(), entry_row[e]) - rows.begin());
      }
      for (const Index c : a.children(s)) {
        const Index* below = a.row.data() + a.row_begin[c] + a.columns(c);
        Index* relative = a.relative.data() + a.row_begin[c] - a.super[c];
        for (Index i = 0, at = 0; i < a.below(c); ++i) {
          while (rows[at] != below[i]) ++at;
          relative[i] = at;
        }
      }
    }
  });
}

double front_flops(double columns, double rows) {
  // Sum of (rows - j)^2 over the columns.
  const double left = rows - columns;
  return (rows * (rows + 1) * (2 * rows + 1) - left * (left + 1) * (2 * left + 1)) / 6;
}

/// The supernodes, and what they were found from: twin rows, each by its place in the elimination.
struct Structure {
  Lists earlier;
  std::vector<Index> width;
  Supernodes found;
};

Structure find_in_order(const SymmetricMatrix& matrix, In<Index> whole) {
  const std::optional<TwinRows> twins = find_twin_rows(matrix, whole);
  Structure structure;
  if (twins) {
    structure.earlier = earlier_neighbours(twins->pattern, inverse(twins->order));
    for (const Index g : twins->order) structure.width.push_back(twins->width(g));
  } else {
    structure.earlier = earlier_neighbours(matrix, inverse(whole));
    structure.width.assign(whole.size(), 1);
  }
  structure.found = find_supernodes(structure.earlier, structure.width);
  return structure;
}

Failure no_memory() {
  return fail(ErrorCode::OutOfMemory, "not enough memory for the analysis of the sparse factor");
}

}  // namespace

double CholeskyAnalysis::flops() const {
  double sum = 0;
  for (Index s = 0; s < num_supernodes(); ++s) sum += front_flops(columns(s), rows(s));
  return sum;
}

Result<CholeskyAnalysis> analyse_cholesky(const Exec& exec, const SymmetricMatrix& matrix,
                                          In<Index> order) try {
  CholeskyAnalysis a;
  a.permutation = whole_order(order, matrix.size());
  auto [earlier, width, found] = find_in_order(matrix, a.permutation);
  const std::vector<Index> by_order = std::exchange(a.permutation, std::vector<Index>(matrix.size()));
  for (std::size_t k = 0; k < by_order.size(); ++k) a.permutation[found.place[k]] = by_order[k];
  a.parent = std::move(found.parent);
  a.super = exclusive_scan(found.columns);
  a.row_begin = exclusive_scan(found.rows);
  a.value_begin.assign(1, 0);
  std::vector<double> work;
  std::vector<Index> supernode_of(matrix.size());
  for (Index s = 0; s < a.num_supernodes(); ++s) {
    a.value_begin.push_back(a.value_begin.back() + static_cast<Offset>(a.columns(s)) * a.rows(s));
    if (a.value_begin[s + 1] - a.value_begin[s] > std::numeric_limits<Index>::max()) return no_memory();
    work.push_back(front_flops(a.columns(s), a.rows(s)));
    std::fill(supernode_of.begin() + a.super[s], supernode_of.begin() + a.super[s + 1], s);
  }
  a.tasks = split_into_subtrees(a.parent, work, kTaskShare, kLeastTask);
  std::vector<Index> begin = exclusive_scan(width);  // in the order, then in the elimination
  for (Index& row : begin) row = row < a.size() ? found.place[row] : row;
  fill_rows(earlier, begin, supernode_of, a);
  list_children(a);
  fill_places(exec, matrix, inverse(a.permutation), supernode_of, a);
  return a;
} catch (const std::bad_alloc&) {
  return no_memory();
}

Result<Offset> count_factor(const SymmetricMatrix& matrix, In<Index> order) try {
  const Supernodes found = find_in_order(matrix, whole_order(order, matrix.size())).found;
  Offset entries = 0;
  for (std::size_t s = 0; s < found.columns.size(); ++s)
    entries += static_cast<Offset>(found.columns[s]) * found.rows[s];
  return entries;
} catch (const std::bad_alloc&) {
  return no_memory();
}

}  // namespace planish
