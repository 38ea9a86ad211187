#include "engine/exec/large_array.hpp"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace planish {

void* allocate_pages(std::size_t bytes) noexcept {
  constexpr std::size_t kLargePage = std::size_t{1} << 21, kLine = 64;
  const std::size_t page = bytes >= kLargePage ? kLargePage : kLine;
  const std::size_t whole = (bytes + page - 1) / page * page;
  if (whole < bytes) return nullptr;
  void* const memory = std::aligned_alloc(page, whole);
#ifdef __linux__
  // A wish: where it is not granted the pages are small, and all else is the same.
  if (memory && page == kLargePage) madvise(memory, whole, MADV_HUGEPAGE);
#endif
  return memory;
}

void discard_pages(void* begin, void* end) noexcept {
#ifdef __linux__
  constexpr std::uintptr_t kPage = 4096;
  const std::uintptr_t first = (reinterpret_cast<std::uintptr_t>(begin) + kPage - 1) / kPage * kPage,
                       last = reinterpret_cast<std::uintptr_t>(end) / kPage * kPage;
  if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
#else
  static_cast<void>(begin), static_cast<void>(end);
#endif
}

}  // namespace planish
