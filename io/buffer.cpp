#include "io/buffer.hpp"

#include <sys/mman.h>

#include <cstring>

namespace planish {

bool Buffer::reserve(std::size_t capacity) {
  if (capacity <= capacity_) return true;
  constexpr std::size_t kHugePage = std::size_t{1} << 21;
  char* bytes = nullptr;
  if (capacity < 4 * kHugePage) {
    bytes = static_cast<char*>(std::malloc(capacity));
  } else {
    // First touch of 4 kB pages takes longer than the copy from the page cache; huge pages halve the time to
    // read.
    capacity = (capacity + kHugePage - 1) / kHugePage * kHugePage;
    bytes = static_cast<char*>(std::aligned_alloc(kHugePage, capacity));
    if (bytes != nullptr) madvise(bytes, capacity, MADV_HUGEPAGE);
  }
  if (bytes == nullptr) return false;
  if (size_ > 0) std::memcpy(bytes, bytes_.get(), size_);
  bytes_.reset(bytes);
  capacity_ = capacity;
  return true;
}

}  // namespace planish
