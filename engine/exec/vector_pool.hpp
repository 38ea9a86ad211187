// Arrays of points that are used again: the system clears the pages of new ones, which costs as much as writing them.
#pragma once

#include <algorithm>
#include <new>
#include <utility>
#include <vector>

#include "kernels/base/types.hpp"

namespace planish {

/// For one caller at a time.
class VectorPool {
 public:
  /// Values are whatever was in it; 0 in what is new.
  std::vector<Vec2> take(std::size_t size) {
    std::vector<Vec2> taken;
    if (!free_.empty()) {
      taken = std::move(free_.back());
      free_.pop_back();
    }
    taken.resize(size);
    return taken;
  }
  std::vector<Vec2> copy(In<Vec2> of) {
    std::vector<Vec2> taken = take(of.size());
    std::copy(of.begin(), of.end(), taken.begin());
    return taken;
  }
  /// Without room to note it down it is freed.
  void give(std::vector<Vec2>&& used) noexcept {
    try {
      if (used.capacity() > 0) free_.push_back(std::move(used));
    } catch (const std::bad_alloc&) {
      used = {};
    }
  }

 private:
  std::vector<std::vector<Vec2>> free_;
};

}  // namespace planish
