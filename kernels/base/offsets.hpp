// Compressed rows: group i holds the entries [begin[i], begin[i + 1]) of an array beside it.
#pragma once

#include "kernels/base/types.hpp"

namespace planish {

/// View of group offsets, begin [n + 1], ascending.
struct Offsets {
  In<Index> begin;
  Index size() const { return static_cast<Index>(begin.size()) - 1; }
  Range group(Index i) const { return {begin[i], begin[i + 1]}; }
};

template <class T>
In<T> slice(In<T> values, Range r) {
  return values.subspan(r.begin, r.end - r.begin);
}

}  // namespace planish
