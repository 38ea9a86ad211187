// The elimination tree of a sparse symmetric matrix, and what follows from it without the factor: the columns' counts and
// the supernodes.
#pragma once

#include "kernels/base/offsets.hpp"

namespace planish {

/// Parent of each column in the elimination tree; kNone at roots.
///   earlier [n groups] the neighbours of each row that are eliminated before it
///   parent [n] out;  ancestor [n] scratch
/// Cost: near O(nonzeros).   Ref: Liu 1990, algorithm 4.2 (paths compressed).
void elimination_tree(const Offsets& earlier, In<Index> earlier_row, Out<Index> parent, Out<Index> ancestor);

/// Depth-first order of a forest whose parents come after their children: order[k] is the k-th, every subtree a contiguous
/// range that ends with its root. Children come in ascending rank, equal ones in the order of their numbers.
///   rank [n];   order [n] out;  head, next [n] scratch
/// Cost: O(n), and a sort of the nodes by rank.
void postorder(In<Index> parent, In<Index> rank, Out<Index> order, Out<Index> head, Out<Index> next);

/// Scratch of column_counts, [n] each.
struct CountScratch {
  Out<Index> first, latest_leaf, previous_leaf, ancestor;
};

/// Entries of each column of the factor, diagonal included, where row i stands for weight[i] rows.
///   post [n] a postorder of the tree;   later [n groups] the neighbours of each row that are eliminated after it
///   count [n] out
/// Cost: near O(nonzeros).   Ref: Gilbert, Ng and Peyton 1994; Davis 2006, section 4.5.
void column_counts(In<Index> parent, In<Index> post, const Offsets& later, In<Index> later_row,
                   In<Index> weight, Out<Index> count, const CountScratch& scratch);

/// When a supernode takes in a child, at the cost of zeros in the panel: always up to `always` columns, else where the zeros
/// are at most that share of the entries.
struct Relaxation {
  Index always = 4;
  Index small = 16, medium = 48;  ///< columns
  double small_share = 0.3, medium_share = 0.1, share = 0.05;
};

/// Supernodes: chains of columns with one structure, then merged with children as far as the relaxation allows.
/// Columns are postordered: column k of the arrays is the k-th of the postorder.
struct SupernodeArrays {
  Out<Index> columns;                  ///< [n] of each supernode
  Out<Index> rows;                     ///< [n] of its panel, its own columns included
  Out<Index> parent;                   ///< [n] supernode, kNone at roots
  Out<Index> merged;                   ///< [n] supernode that took this one in, or kNone
  Out<Index> first;                    ///< [n] first column of the chain that it began as
  Out<Index> next_chain;               ///< [n] next chain in the supernode, or kNone
  Out<Index> first_chain, last_chain;  ///< [n] chains of the supernode in order; each is a supernode's number
  Out<double> zeros;                   ///< [n] entries of the panel that are zeros
};

/// Returns the number of chains; those with merged[s] == kNone are the supernodes.
///   parent, count [n] of the columns, postordered;   chain_of [n] out: chain of each column
///   head, next [n] scratch
Index find_supernodes(In<Index> parent, In<Index> count, const Relaxation& relaxation, Out<Index> chain_of,
                      const SupernodeArrays& out, Out<Index> head, Out<Index> next);

}  // namespace planish
