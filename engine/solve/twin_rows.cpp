#include "engine/solve/twin_rows.hpp"

#include <algorithm>

namespace planish {
namespace {

In<Index> rows_below(const SymmetricMatrix& matrix, Index column) {
  const Index begin = matrix.column_begin[column] + 1;
  return In<Index>(matrix.row).subspan(begin, matrix.column_begin[column + 1] - begin);
}

/// [n] whether row j and the next one are eliminated one after the other and have the same rows below.
std::vector<std::uint8_t> candidates(const SymmetricMatrix& matrix, In<Index> order) {
  const Index n = matrix.size();
  std::vector<std::uint8_t> with_next(n, 0);
  for (std::size_t k = 0; k + 1 < order.size(); ++k) {
    const Index j = order[k];
    if (order[k + 1] != j + 1 || (j > 0 && with_next[j - 1])) continue;
    const In<Index> rows = rows_below(matrix, j), next = rows_below(matrix, j + 1);
    with_next[j] = !rows.empty() && rows.front() == j + 1 &&
                   std::equal(rows.begin() + 1, rows.end(), next.begin(), next.end());
  }
  return with_next;
}

/// Takes back what is not coupled with the same columns before.
void part_those_seen_apart(const SymmetricMatrix& matrix, Out<std::uint8_t> with_next) {
  for (Index j = 0; j < matrix.size(); ++j) {
    const In<Index> rows = rows_below(matrix, j);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Index i = rows[k];
      if (with_next[i] && (k + 1 == rows.size() || rows[k + 1] != i + 1)) with_next[i] = 0;
      const bool before = i == j + 1 || (k > 0 && rows[k - 1] == i - 1);
      if (with_next[i - 1] && !before) with_next[i - 1] = 0;
    }
  }
}

}  // namespace

std::optional<TwinRows> find_twin_rows(const SymmetricMatrix& matrix, In<Index> order) {
  constexpr double kLeastShare = 0.125;
  const Index n = matrix.size();
  std::vector<std::uint8_t> with_next = candidates(matrix, order);
  const auto pairs = static_cast<double>(std::count(with_next.begin(), with_next.end(), 1));
  if (pairs < kLeastShare * n) return std::nullopt;
  part_those_seen_apart(matrix, with_next);
  TwinRows twins;
  std::vector<Index> group(n);
  for (Index j = 0; j < n; ++j) {
    if (j == 0 || !with_next[j - 1]) twins.first.push_back(j);
    group[j] = static_cast<Index>(twins.first.size()) - 1;
  }
  twins.first.push_back(n);
  const auto is_first = [&](Index j) { return j == twins.first[group[j]]; };
  twins.pattern.column_begin.assign(1, 0);
  for (std::size_t g = 0; g + 1 < twins.first.size(); ++g) {
    twins.pattern.row.push_back(static_cast<Index>(g));
    for (const Index i : rows_below(matrix, twins.first[g])) {
      if (is_first(i)) twins.pattern.row.push_back(group[i]);
    }
    twins.pattern.column_begin.push_back(static_cast<Index>(twins.pattern.row.size()));
  }
  for (const Index j : order) {
    if (is_first(j)) twins.order.push_back(group[j]);
  }
  return twins;
}

}  // namespace planish
