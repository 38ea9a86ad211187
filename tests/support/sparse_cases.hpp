// Random sparse positive definite matrices, and their factors found without cleverness.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "engine/solve/symmetric_matrix.hpp"
#include "tests/support/shapes.hpp"

namespace planish::sparse_cases {

/// The lower triangle from entries (row > column) with a diagonal that makes it definite.
inline SymmetricMatrix from_edges(Index n, const std::set<std::pair<Index, Index>>& edges,
                                  shapes::Random& random, double shift = 0.1) {
  std::vector<std::map<Index, double>> column(n);
  std::vector<double> diagonal(n, shift);
  for (const auto& [row, col] : edges) {
    const double value = random.uniform() - 0.7;
    column[col][row] = value;
    diagonal[row] += std::abs(value);
    diagonal[col] += std::abs(value);
  }
  SymmetricMatrix matrix;
  matrix.column_begin = {0};
  for (Index j = 0; j < n; ++j) {
    matrix.row.push_back(j);
    matrix.value.push_back(diagonal[j]);
    for (const auto& [row, value] : column[j]) matrix.row.push_back(row), matrix.value.push_back(value);
    matrix.column_begin.push_back(static_cast<Index>(matrix.row.size()));
  }
  return matrix;
}

/// n rows with about `degree` entries each beside the diagonal, anywhere.
inline SymmetricMatrix random_matrix(Index n, double degree, shapes::Random& random) {
  std::set<std::pair<Index, Index>> edges;
  const auto draw = [&] { return std::min(n - 1, static_cast<Index>(random.uniform() * n)); };
  for (Index k = 0; k < static_cast<Index>(n * degree / 2); ++k) {
    const Index a = draw(), b = draw();
    if (a != b) edges.insert({std::max(a, b), std::min(a, b)});
  }
  return from_edges(n, edges, random);
}

/// Rows of each column of the factor in the given order, the diagonal first: elimination on sets.
inline std::vector<std::set<Index>> factor_pattern(const SymmetricMatrix& matrix, In<Index> order) {
  const Index n = matrix.size();
  std::vector<Index> place(n);
  for (Index k = 0; k < n; ++k) place[order[k]] = k;
  std::vector<std::set<Index>> column(n);
  for (Index j = 0; j < n; ++j) {
    for (Index k = matrix.column_begin[j]; k < matrix.column_begin[j + 1]; ++k) {
      const Index a = place[j], b = place[matrix.row[k]];
      column[std::min(a, b)].insert(std::max(a, b));
    }
  }
  for (Index j = 0; j < n; ++j) {
    if (column[j].size() < 2) continue;
    const Index parent = *std::next(column[j].begin());
    column[parent].insert(std::next(column[j].begin()), column[j].end());
  }
  return column;
}

}  // namespace planish::sparse_cases
