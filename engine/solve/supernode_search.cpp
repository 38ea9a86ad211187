#include "engine/solve/supernode_search.hpp"

#include <utility>

#include "engine/exec/parallel.hpp"
#include "kernels/sparse/etree.hpp"

namespace planish {
namespace {

Lists transposed(const Lists& lists) {
  const auto n = static_cast<Index>(lists.begin.size()) - 1;
  std::vector<Index> count(n, 0);
  for (const Index i : lists.row) ++count[i];
  Lists result;
  result.begin = exclusive_scan(count);
  result.row.resize(lists.row.size());
  std::copy_n(result.begin.begin(), n, count.begin());
  for (Index k = 0; k < n; ++k) {
    for (const Index i : slice(In<Index>(lists.row), lists.offsets().group(k))) result.row[count[i]++] = k;
  }
  return result;
}

class SupernodeSearch {
 public:
  /// earlier: of rows that stand for width [G] rows each, by places in the order
  SupernodeSearch(const Lists& earlier, In<Index> width) {
    const auto num = static_cast<Index>(width.size());
    std::vector<Index> parent(num), count(num), post(num), head(num), next(num);
    elimination_tree(earlier.offsets(), earlier.row, parent, head);
    postorder(parent, std::vector<Index>(num, 0), post, head, next);
    const Lists later = transposed(earlier);
    std::vector<Index> first(num), latest(num), previous(num);
    column_counts(parent, post, later.offsets(), later.row, width, count, {first, latest, previous, head});
    expand(parent, count, post, width);
  }

  Supernodes find(const Relaxation& relaxation) {
    std::vector<Index> chain_of(n_), head(n_), next(n_);
    std::vector<Index> columns(n_), rows(n_), above(n_), merged(n_), first(n_), next_chain(n_),
        first_chain(n_), last_chain(n_);
    std::vector<double> zeros(n_);
    const Index num_chains = find_supernodes(
        parent_, count_, relaxation, chain_of,
        {columns, rows, above, merged, first, next_chain, first_chain, last_chain, zeros}, head, next);
    // The supernodes, numbered as they come, then postordered with small panels first.
    std::vector<Index> number(num_chains, kNone), chain;
    for (Index c = 0; c < num_chains; ++c) {
      if (merged[c] != kNone) continue;
      number[c] = static_cast<Index>(chain.size());
      chain.push_back(c);
    }
    const auto num = static_cast<Index>(chain.size());
    std::vector<Index> tree(num), rank(num), order(num);
    for (Index s = 0; s < num; ++s) {
      tree[s] = above[chain[s]] == kNone ? kNone : number[holder(merged, above[chain[s]])];
      rank[s] = rows[chain[s]];
    }
    postorder(tree, rank, order, Out<Index>(head).first(num), next);
    const std::vector<Index> place_of = inverse(order);
    std::vector<Index> chain_length(num_chains, 0);
    for (const Index c : chain_of) ++chain_length[c];
    Supernodes result;
    result.place.resize(n_);
    Index column = 0;
    for (const Index s : order) {
      const Index c = chain[s];
      result.columns.push_back(columns[c]);
      result.rows.push_back(rows[c]);
      result.parent.push_back(tree[s] == kNone ? kNone : place_of[tree[s]]);
      for (Index part = first_chain[c]; part != kNone; part = next_chain[part]) {
        for (Index k = first[part]; k < first[part] + chain_length[part]; ++k)
          result.place[row_[k]] = column++;
      }
    }
    return result;
  }

 private:
  /// The supernode that a chain ended up in; the way there is shortened.
  static Index holder(std::vector<Index>& merged, Index chain) {
    Index last = chain;
    while (merged[last] != kNone) last = merged[last];
    while (merged[chain] != kNone) chain = std::exchange(merged[chain], last);
    return last;
  }

  /// The rows that each stands for, one the parent of the one before.
  void expand(In<Index> parent, In<Index> count, In<Index> post, In<Index> width) {
    std::vector<Index> begin = exclusive_scan(width), place(post.size());
    n_ = begin.back();
    for (std::vector<Index>* column : {&row_, &count_, &parent_}) column->reserve(n_);
    Index next = 0;
    for (const Index g : post) {
      place[g] = next;
      for (Index i = 0; i < width[g]; ++i, ++next) {
        row_.push_back(begin[g] + i);
        count_.push_back(count[g] - i);
        parent_.push_back(next + 1);
      }
    }
    for (const Index g : post)
      parent_[place[g] + width[g] - 1] = parent[g] == kNone ? kNone : place[parent[g]];
  }

  Index n_ = 0;
  // By places in the postorder: which row of the order, its parent's place, its column's entries.
  std::vector<Index> row_, parent_, count_;
};

}  // namespace

Supernodes find_supernodes(const Lists& earlier, In<Index> width) {
  return SupernodeSearch(earlier, width).find({});
}

}  // namespace planish
