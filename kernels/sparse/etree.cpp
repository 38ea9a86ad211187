#include "kernels/sparse/etree.hpp"

#include <algorithm>

namespace planish {

void elimination_tree(const Offsets& earlier, In<Index> earlier_row, Out<Index> parent, Out<Index> ancestor) {
  for (Index k = 0; k < earlier.size(); ++k) {
    parent[k] = ancestor[k] = kNone;
    for (Index i : slice(earlier_row, earlier.group(k))) {
      while (i != kNone && i < k) {
        const Index above = ancestor[i];
        ancestor[i] = k;
        if (above == kNone) parent[i] = k;
        i = above;
      }
    }
  }
}

namespace {

/// Lists of children by parent, ascending; roots (parent kNone) stay out.
void list_children(In<Index> parent, Out<Index> head, Out<Index> next) {
  std::fill(head.begin(), head.end(), kNone);
  for (std::size_t k = parent.size(); k-- > 0;) {
    if (parent[k] == kNone) continue;
    next[k] = head[parent[k]];
    head[parent[k]] = static_cast<Index>(k);
  }
}

/// Sorts a list of siblings by rank, stable: they are few, or already nearly in order.
Index sort_siblings(Index first, In<Index> rank, Out<Index> next) {
  Index sorted = kNone, last = kNone;
  while (first != kNone) {
    const Index node = first;
    first = next[node];
    if (last == kNone || rank[node] >= rank[last]) {
      (last == kNone ? sorted : next[last]) = node;
      last = node;
      next[node] = kNone;
      continue;
    }
    Index* place = &sorted;
    while (rank[*place] <= rank[node]) place = &next[*place];
    next[node] = *place;
    *place = node;
  }
  return sorted;
}

}  // namespace

void postorder(In<Index> parent, In<Index> rank, Out<Index> order, Out<Index> head, Out<Index> next) {
  list_children(parent, head, next);
  const auto n = static_cast<Index>(parent.size());
  Index done = 0;
  for (Index root = 0; root < n; ++root) {
    if (parent[root] != kNone) continue;
    Index node = root;
    while (node != kNone) {
      // Down to the first leaf; a child leaves its parent's list when it is entered.
      while (head[node] != kNone) {
        head[node] = sort_siblings(head[node], rank, next);
        const Index child = head[node];
        head[node] = next[child];
        node = child;
      }
      order[done++] = node;
      node = node == root ? kNone : parent[node];
    }
  }
}

namespace {

/// Whether column j is a leaf of row i's subtree, and of the last two leaves the least common ancestor, where the second
/// path ends; kNone where it is no leaf or the first one.
struct Leaf {
  bool is_leaf = false;
  Index meeting = kNone;
};

Leaf leaf(Index i, Index j, const CountScratch& s) {
  if (s.first[j] <= s.latest_leaf[i]) return {};
  s.latest_leaf[i] = s.first[j];
  const Index previous = s.previous_leaf[i];
  s.previous_leaf[i] = j;
  if (previous == kNone) return {true, kNone};
  Index meeting = previous;
  while (meeting != s.ancestor[meeting]) meeting = s.ancestor[meeting];
  for (Index k = previous; k != meeting;) {
    const Index above = s.ancestor[k];
    s.ancestor[k] = meeting;
    k = above;
  }
  return {true, meeting};
}

}  // namespace

void column_counts(In<Index> parent, In<Index> post, const Offsets& later, In<Index> later_row,
                   In<Index> weight, Out<Index> count, const CountScratch& s) {
  const auto n = static_cast<Index>(parent.size());
  std::fill(s.first.begin(), s.first.end(), kNone);
  for (Index k = 0; k < n; ++k) {  // first[j]: the first descendant's place in the postorder
    Index j = post[k];
    count[j] = s.first[j] == kNone ? weight[j] : 0;
    for (; j != kNone && s.first[j] == kNone; j = parent[j]) s.first[j] = k;
  }
  std::fill(s.latest_leaf.begin(), s.latest_leaf.end(), kNone);
  std::fill(s.previous_leaf.begin(), s.previous_leaf.end(), kNone);
  for (Index j = 0; j < n; ++j) s.ancestor[j] = j;
  for (const Index j : post) {
    if (parent[j] != kNone) count[parent[j]] -= weight[j];
    for (const Index i : slice(later_row, later.group(j))) {
      const Leaf found = leaf(i, j, s);
      if (found.is_leaf) count[j] += weight[i];
      if (found.meeting != kNone) count[found.meeting] -= weight[i];
    }
    if (parent[j] != kNone) s.ancestor[j] = parent[j];
  }
  for (const Index j : post) {
    if (parent[j] != kNone) count[parent[j]] += count[j];
  }
}

namespace {

double panel_entries(double columns, double rows) { return columns * rows - columns * (columns - 1) / 2; }

bool allows(const Relaxation& r, Index columns, Index rows, double zeros) {
  if (columns <= r.always) return true;
  const double share = zeros / panel_entries(columns, rows);
  return share <= (columns <= r.small ? r.small_share : columns <= r.medium ? r.medium_share : r.share);
}

void take_in(Index s, Index child, double zeros, const SupernodeArrays& a) {
  a.merged[child] = s;
  a.columns[s] += a.columns[child];
  a.rows[s] += a.columns[child];
  a.zeros[s] = zeros;
  a.next_chain[a.last_chain[child]] = a.first_chain[s];
  a.first_chain[s] = a.first_chain[child];
}

/// Merges supernode s with those of its children that the relaxation allows; theirs become its own, and are not looked at
/// again.
void merge_children(Index s, const Relaxation& relaxation, const SupernodeArrays& a, Out<Index> head,
                    Out<Index> next) {
  Index kept = kNone;
  for (Index child = head[s]; child != kNone;) {
    const Index following = next[child];
    const double zeros = a.zeros[s] + a.zeros[child] +
                         static_cast<double>(a.columns[child]) *
                             (static_cast<double>(a.columns[child]) + a.rows[s] - a.rows[child]);
    if (allows(relaxation, a.columns[s] + a.columns[child], a.rows[s] + a.columns[child], zeros)) {
      take_in(s, child, zeros, a);
      for (Index inner = head[child]; inner != kNone;) {
        const Index after = next[inner];
        a.parent[inner] = s;
        next[inner] = kept;
        kept = inner;
        inner = after;
      }
    } else {
      next[child] = kept;
      kept = child;
    }
    child = following;
  }
  head[s] = kept;
}

}  // namespace

Index find_supernodes(In<Index> parent, In<Index> count, const Relaxation& relaxation, Out<Index> chain_of,
                      const SupernodeArrays& a, Out<Index> head, Out<Index> next) {
  const auto n = static_cast<Index>(parent.size());
  Index num_chains = 0;
  for (Index k = 0; k < n; ++k) {
    const bool continues = k > 0 && parent[k - 1] == k && count[k - 1] == count[k] + 1;
    if (!continues) {
      const Index s = num_chains++;
      a.first[s] = k;
      a.columns[s] = 0;
      a.rows[s] = count[k];
      a.zeros[s] = 0;
      a.merged[s] = a.next_chain[s] = kNone;
      a.first_chain[s] = a.last_chain[s] = s;
    }
    chain_of[k] = num_chains - 1;
    ++a.columns[num_chains - 1];
  }
  for (Index s = 0; s < num_chains; ++s) {
    const Index above = parent[a.first[s] + a.columns[s] - 1];
    a.parent[s] = above == kNone ? kNone : chain_of[above];
  }
  list_children(a.parent.first(num_chains), head.first(num_chains), next);
  for (Index s = 0; s < num_chains; ++s) merge_children(s, relaxation, a, head, next);
  return num_chains;
}

}  // namespace planish
