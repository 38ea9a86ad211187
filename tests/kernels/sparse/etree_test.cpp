#include "kernels/sparse/etree.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "tests/support/sparse_cases.hpp"

using namespace planish;

namespace {

/// The tree of a random matrix in its own order, by the kernels and by elimination on sets.
struct Tree {
  std::vector<std::set<Index>> pattern;
  std::vector<Index> earlier_begin{0}, earlier, later_begin{0}, later;
  std::vector<Index> parent, post, count;
  Index n;

  Tree(Index size, double degree, shapes::Random& random) : n(size) {
    const SymmetricMatrix matrix = sparse_cases::random_matrix(n, degree, random);
    std::vector<Index> natural(n);
    std::iota(natural.begin(), natural.end(), 0);
    pattern = sparse_cases::factor_pattern(matrix, natural);
    std::vector<std::vector<Index>> rows(n);
    for (Index j = 0; j < n; ++j) {
      for (Index k = matrix.column_begin[j] + 1; k < matrix.column_begin[j + 1]; ++k) {
        later.push_back(matrix.row[k]);
        rows[matrix.row[k]].push_back(j);
      }
      later_begin.push_back(static_cast<Index>(later.size()));
    }
    for (Index i = 0; i < n; ++i) {
      earlier.insert(earlier.end(), rows[i].begin(), rows[i].end());
      earlier_begin.push_back(static_cast<Index>(earlier.size()));
    }
    parent.resize(n), post.resize(n), count.resize(n);
    std::vector<Index> a(n), b(n), c(n), d(n);
    elimination_tree({earlier_begin}, earlier, parent, a);
    postorder(parent, std::vector<Index>(n, 0), post, a, b);
    column_counts(parent, post, {later_begin}, later, std::vector<Index>(n, 1), count, {a, b, c, d});
  }

  /// The pattern with columns renumbered by the postorder.
  Tree& renumber() {
    std::vector<Index> place(n);
    for (Index k = 0; k < n; ++k) place[post[k]] = k;
    std::vector<std::set<Index>> moved(n);
    std::vector<Index> new_parent(n), new_count(n);
    for (Index k = 0; k < n; ++k) {
      for (const Index i : pattern[post[k]]) moved[k].insert(place[i]);
      new_parent[k] = parent[post[k]] == kNone ? kNone : place[parent[post[k]]];
      new_count[k] = count[post[k]];
    }
    pattern = std::move(moved), parent = std::move(new_parent), count = std::move(new_count);
    return *this;
  }
};

struct Found {
  std::vector<Index> chain_of, columns, rows, parent, merged, first, next_chain, first_chain, last_chain;
  std::vector<double> zeros;
  Index num_chains;

  Found(const Tree& tree, const Relaxation& relaxation) {
    const auto size = static_cast<std::size_t>(tree.n);
    for (auto* array :
         {&chain_of, &columns, &rows, &parent, &merged, &first, &next_chain, &first_chain, &last_chain})
      array->resize(size);
    zeros.resize(size);
    std::vector<Index> head(size), next(size);
    num_chains = find_supernodes(
        tree.parent, tree.count, relaxation, chain_of,
        {columns, rows, parent, merged, first, next_chain, first_chain, last_chain, zeros}, head, next);
  }

  /// Columns of a supernode, in its order.
  std::vector<Index> columns_of(Index s) const {
    std::vector<Index> result;
    for (Index chain = first_chain[s]; chain != kNone; chain = next_chain[chain]) {
      for (Index k = first[chain]; k < static_cast<Index>(chain_of.size()) && chain_of[k] == chain; ++k)
        result.push_back(k);
    }
    return result;
  }
};

}  // namespace

TEST_CASE("etree: parents are the first rows below the diagonal, counts the columns' lengths") {
  shapes::Random random(21);
  for (const Index n : {1, 2, 7, 40, 150}) {
    for (const double degree : {0.0, 1.0, 2.5, 6.0}) {
      const Tree tree(n, degree, random);
      for (Index j = 0; j < n; ++j) {
        const auto below = std::next(tree.pattern[j].begin());
        CHECK(tree.parent[j] == (below == tree.pattern[j].end() ? kNone : *below));
        CHECK(tree.count[j] == static_cast<Index>(tree.pattern[j].size()));
      }
    }
  }
}

TEST_CASE("etree: where rows stand for several, counts are those of all of them") {
  shapes::Random random(24);
  for (int repeat = 0; repeat < 10; ++repeat) {
    const Index n = 80;
    const Tree tree(n, 3, random);
    std::vector<Index> weight(n), count(n), a(n), b(n), c(n), d(n);
    for (Index& w : weight) w = 1 + static_cast<Index>(random.uniform() * 3);
    column_counts(tree.parent, tree.post, {tree.later_begin}, tree.later, weight, count, {a, b, c, d});
    for (Index j = 0; j < n; ++j) {
      Index sum = 0;
      for (const Index i : tree.pattern[j]) sum += weight[i];
      CHECK(count[j] == sum);
    }
  }
}

TEST_CASE("etree: in a postorder every subtree is a range that ends with its root, siblings by rank") {
  shapes::Random random(22);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Index n = 60;
    const Tree tree(n, 2.2, random);
    std::vector<Index> rank(n), order(n), head(n), next(n), place(n, kNone);
    for (Index& r : rank) r = static_cast<Index>(random.uniform() * 5);
    postorder(tree.parent, rank, order, head, next);
    for (Index k = 0; k < n; ++k) place[order[k]] = k;
    std::vector<Index> size(n, 1);
    for (const Index j : order) {
      if (tree.parent[j] != kNone) size[tree.parent[j]] += size[j];
    }
    std::vector<Index> last_rank(n, kNone), end(n, kNone);
    for (const Index j : order) {
      const Index p = tree.parent[j];
      if (p == kNone) continue;
      CHECK(place[j] < place[p]);
      CHECK(place[j] > place[p] - size[p]);
      CHECK(rank[j] >= last_rank[p]);
      last_rank[p] = rank[j];
    }
  }
}

TEST_CASE("etree: supernodes without relaxation are columns of one structure, as long as they can be") {
  shapes::Random random(23);
  for (int repeat = 0; repeat < 10; ++repeat) {
    Tree tree(80, 3, random);
    tree.renumber();
    const Found found(
        tree, {.always = 0, .small = 0, .medium = 0, .small_share = 0, .medium_share = 0, .share = -1});
    for (Index s = 0; s < found.num_chains; ++s) {
      CHECK(found.merged[s] == kNone);
      CHECK(found.zeros[s] == 0);
      const std::vector<Index> columns = found.columns_of(s);
      CHECK(static_cast<Index>(columns.size()) == found.columns[s]);
      CHECK(static_cast<Index>(tree.pattern[columns.front()].size()) == found.rows[s]);
      for (std::size_t k = 1; k < columns.size(); ++k) {
        std::set<Index> shorter = tree.pattern[columns[k - 1]];
        shorter.erase(shorter.begin());
        CHECK(tree.pattern[columns[k]] == shorter);
      }
    }
  }
}

TEST_CASE("etree: relaxed supernodes hold their columns' structures and no more zeros than they say") {
  shapes::Random random(24);
  int merged = 0;
  for (int repeat = 0; repeat < 10; ++repeat) {
    Tree tree(120, 2.5, random);
    tree.renumber();
    const Found found(tree, {});
    Index columns = 0;
    for (Index s = 0; s < found.num_chains; ++s) {
      if (found.merged[s] != kNone) {
        ++merged;
        continue;
      }
      std::set<Index> rows;
      double entries = 0;
      for (const Index j : found.columns_of(s)) {
        ++columns;
        rows.insert(tree.pattern[j].begin(), tree.pattern[j].end());
        entries += static_cast<double>(tree.pattern[j].size());
      }
      CHECK(static_cast<Index>(rows.size()) == found.rows[s]);
      const double c = found.columns[s], r = found.rows[s];
      CHECK(found.zeros[s] == c * r - c * (c - 1) / 2 - entries);
    }
    CHECK(columns == tree.n);
  }
  CHECK(merged > 100);
}
