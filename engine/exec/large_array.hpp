// Memory for what is written once and read often: not cleared, in large pages where the system gives them.
#pragma once

#include <cstdlib>
#include <memory>
#include <new>

#include "kernels/base/types.hpp"

namespace planish {

/// Bytes on a boundary of large pages, untouched; nullptr where there are not so many.
void* allocate_pages(std::size_t bytes) noexcept;

/// Gives the whole pages within [begin, end) of such memory back to the system, where it takes them: what they held is lost.
void discard_pages(void* begin, void* end) noexcept;

/// Fixed-size array of numbers whose values are not set: the first to write them are the threads that use them.
template <class T>
class LargeArray {
 public:
  LargeArray() = default;
  /// Throws std::bad_alloc.
  explicit LargeArray(Offset size) : size_(size) {
    if (size == 0) return;
    value_.reset(static_cast<T*>(allocate_pages(sizeof(T) * static_cast<std::size_t>(size))));
    if (!value_) throw std::bad_alloc();
  }
  T* data() { return value_.get(); }
  const T* data() const { return value_.get(); }
  Offset size() const { return size_; }
  /// The values [begin, end) are not needed any more, their memory may go before that of the others.
  void discard(Offset begin, Offset end) { discard_pages(data() + begin, data() + end); }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::unique_ptr<T, Free> value_;
  Offset size_ = 0;
};

}  // namespace planish
