// Parallel loops over fixed blocks. The block size is part of the algorithm and never depends on the number
// of threads, so results are the same bits on 1 or 64 of them. TBB stays behind this header.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include "kernels/base/radix.hpp"
#include "kernels/base/sums.hpp"
#include "kernels/base/types.hpp"

namespace planish {

/// Where loops run: the caller's own TBB arena, or one with a given number of threads.
class Exec {
 public:
  /// threads = 0: the arena of the calling thread as it is. A positive number: an arena of its own with so
  /// many.
  explicit Exec(int threads = 0);
  ~Exec();
  Exec(const Exec&) = delete;
  Exec& operator=(const Exec&) = delete;

  int threads() const;

  /// Calls body(block, Range) for every block of `block` consecutive indices of [0, n); concurrently, in any
  /// order.
  template <class Body>
  void for_blocks(Index n, Index block, Body&& body) const {
    const auto call = [&](Index k) { body(k, block_range(n, block, k)); };
    run(num_blocks(n, block),
        std::cref(call));  // by reference, which a function holds without memory of its own
  }

  /// Calls body(i) for i in [0, count), each a task of its own.
  template <class Body>
  void for_tasks(Index count, Body&& body) const {
    run(count, [&](Index k) { body(k); });
  }

  /// Sum of body(Range) over all blocks, added in block order by a fixed tree.
  template <class Body>
  double sum_blocks(Index n, Index block, Body&& body) const {
    std::vector<double> partial(num_blocks(n, block));
    for_blocks(n, block, [&](Index k, Range r) { partial[k] = body(r); });
    return pairwise_sum(partial);
  }

  /// Runs both, at the same time where a thread is free.
  void both(const std::function<void()>& a, const std::function<void()>& b) const;

  static Index num_blocks(Index n, Index block) {
    return static_cast<Index>((static_cast<Offset>(n) + block - 1) / block);
  }
  static Range block_range(Index n, Index block, Index k) {
    const Offset begin = static_cast<Offset>(k) * block;
    return {static_cast<Index>(begin), static_cast<Index>(std::min<Offset>(n, begin + block))};
  }

 private:
  void run(Index count, const std::function<void(Index)>& body) const;
  struct Arena;
  std::unique_ptr<Arena> arena_;
};

/// Indices a light loop hands out at once: some 20 to 200 microseconds of work.
inline constexpr Index kBlock = 4096;

/// Indices i of [0, n) with holds(i), ascending.
template <class Holds>
std::vector<Index> select(const Exec& exec, Index n, Holds&& holds) {
  std::vector<std::vector<Index>> part(Exec::num_blocks(n, kBlock));
  exec.for_blocks(n, kBlock, [&](Index block, Range r) {
    for (Index i = r.begin; i < r.end; ++i) {
      if (holds(i)) part[block].push_back(i);
    }
  });
  std::vector<Index> selected;
  for (const std::vector<Index>& p : part) selected.insert(selected.end(), p.begin(), p.end());
  return selected;
}

/// Sorts by key, stable; `key_bits` says how many low bits of the keys are in use.
/// Cost: O(n) per 11 bits, one scratch copy of the items.
void sort_by_key(const Exec& exec, std::vector<KeyedIndex>& items, int key_bits);

/// Number of bits that hold all values in [0, n).
int bits_for(std::uint64_t n);

/// begin [counts.size() + 1]: exclusive sums of the counts.
std::vector<Index> exclusive_scan(In<Index> counts);

}  // namespace planish
