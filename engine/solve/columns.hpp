// Gathering a symmetric sparse matrix column by column, in parallel.
#pragma once

#include <algorithm>
#include <vector>

#include "engine/exec/parallel.hpp"
#include "engine/solve/symmetric_matrix.hpp"

namespace planish {

struct Entry {
  Index row;
  double value;
};

/// Sorts the rows behind the diagonal (the first entry) and adds up equal ones, in the order they were given.
inline void merge_rows(std::vector<Entry>& column) {
  std::stable_sort(column.begin() + 1, column.end(),
                   [](const Entry& a, const Entry& b) { return a.row < b.row; });
  std::size_t last = 0;
  for (std::size_t k = 1; k < column.size(); ++k) {
    if (column[k].row == column[last].row) {
      column[last].value += column[k].value;
    } else {
      column[++last] = column[k];
    }
  }
  column.resize(last + 1);
}

/// Receives finished columns of one block, in order.
class ColumnSink {
 public:
  void add(const std::vector<Entry>& column) {
    sizes.push_back(static_cast<Index>(column.size()));
    entries.insert(entries.end(), column.begin(), column.end());
  }
  std::vector<Entry> entries;
  std::vector<Index> sizes;
};

/// Matrix of n columns; gather(Range, sink) adds the columns of a block. Blocks begin at even columns.
template <class Gather>
SymmetricMatrix gather_columns(const Exec& exec, Index n, Gather gather) {
  std::vector<ColumnSink> sinks(Exec::num_blocks(n, kBlock));
  exec.for_blocks(n, kBlock, [&](Index block, Range r) { gather(r, sinks[block]); });
  std::vector<Index> sizes;
  sizes.reserve(n);
  for (const ColumnSink& sink : sinks) sizes.insert(sizes.end(), sink.sizes.begin(), sink.sizes.end());
  SymmetricMatrix matrix;
  matrix.column_begin = exclusive_scan(sizes);
  matrix.row.resize(matrix.column_begin[n]);
  matrix.value.resize(matrix.column_begin[n]);
  exec.for_blocks(n, kBlock, [&](Index block, Range r) {
    Index k = matrix.column_begin[r.begin];
    for (const Entry& e : sinks[block].entries) {
      matrix.row[k] = e.row;
      matrix.value[k++] = e.value;
    }
    sinks[block] = {};
  });
  return matrix;
}

}  // namespace planish
