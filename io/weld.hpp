// One vertex for all corners at the same position.
#pragma once

#include <bit>
#include <vector>

#include "engine/exec/parallel.hpp"

namespace planish {

struct Welded {
  std::vector<Vec3> position;        ///< in order of first occurrence
  std::vector<Index> corner_vertex;  ///< [corners]
};

namespace weld_detail {

/// Negative zero becomes zero; all else is compared by its bits, so that NaN equals itself.
inline std::uint64_t position_bits(double x) { return std::bit_cast<std::uint64_t>(x + 0.0); }

inline std::uint64_t mixed(std::uint64_t h, std::uint64_t bits) {
  h = (h ^ bits) * 0x9e3779b97f4a7c15ULL;
  return h ^ (h >> 32);
}

inline std::uint64_t hash(const Vec3& p) {
  return mixed(mixed(mixed(0, position_bits(p.x)), position_bits(p.y)), position_bits(p.z)) *
             0xff51afd7ed558ccdULL >>
         8;
}

inline bool same(const Vec3& a, const Vec3& b) {
  return position_bits(a.x) == position_bits(b.x) && position_bits(a.y) == position_bits(b.y) &&
         position_bits(a.z) == position_bits(b.z);
}

/// For every item of one group of hashes, the first one at the same position; items come in ascending order.
/// first[c] is written for the group's corners only.
template <class PositionOf>
void find_first(In<KeyedIndex> group, const PositionOf& position_of, std::vector<Index>& table,
                Out<Index> first) {
  const std::size_t size = std::bit_ceil(2 * group.size() + 1);
  table.assign(size, kNone);  // open addressing, entries are places in the group
  for (std::size_t i = 0; i < group.size(); ++i) {
    const Vec3 p = position_of(group[i].index);
    std::size_t slot = (group[i].key >> kRadixBits) & (size - 1);
    while (true) {
      if (table[slot] == kNone) table[slot] = static_cast<Index>(i);
      const KeyedIndex& other = group[table[slot]];
      if (other.key == group[i].key && same(position_of(other.index), p)) {
        first[group[i].index] = other.index;
        break;
      }
      slot = (slot + 1) & (size - 1);
    }
  }
}

}  // namespace weld_detail

/// Welds corners [0, n) at exactly equal positions, where -0 equals 0; position_of(c) gives a Vec3.
/// Cost: O(n) in parallel: one radix pass groups equal hashes, a small table inside each group settles the
/// rest.
template <class PositionOf>
Welded weld(const Exec& exec, Index n, const PositionOf& position_of) {
  using namespace weld_detail;
  std::vector<KeyedIndex> item(n);
  exec.for_blocks(n, kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) item[c] = {hash(position_of(c)), c};
  });
  sort_by_key(exec, item, kRadixBits);
  Welded welded;
  welded.corner_vertex.resize(n);
  std::vector<Index>& first = welded.corner_vertex;  // first corner at the same position, later its vertex
  exec.for_tasks(kRadixDigits, [&](Index digit) {
    const auto group =
        std::ranges::equal_range(item, digit, {}, [](const KeyedIndex& i) { return radix_digit(i.key, 0); });
    std::vector<Index> table;
    if (!group.empty()) find_first({group.data(), group.size()}, position_of, table, first);
  });
  item = {};
  // Vertices are numbered in the order of their first corners.
  std::vector<Index> count(Exec::num_blocks(n, kBlock), 0);
  exec.for_blocks(n, kBlock, [&](Index k, Range r) {
    for (Index c = r.begin; c < r.end; ++c) count[k] += first[c] == c;
  });
  const std::vector<Index> begin = exclusive_scan(count);
  welded.position.resize(begin.back());
  std::vector<Index> vertex(n);  // of first corners
  exec.for_blocks(n, kBlock, [&](Index k, Range r) {
    Index next = begin[k];
    for (Index c = r.begin; c < r.end; ++c) {
      if (first[c] != c) continue;
      const Vec3 p = position_of(c);
      welded.position[next] = {p.x + 0.0, p.y + 0.0, p.z + 0.0};
      vertex[c] = next++;
    }
  });
  exec.for_blocks(n, kBlock, [&](Index, Range r) {
    for (Index c = r.begin; c < r.end; ++c) first[c] = vertex[first[c]];
  });
  return welded;
}

}  // namespace planish
