// Bytes that are not cleared before they are filled: clearing costs as much as reading.
#pragma once

#include <cstdlib>
#include <memory>
#include <string_view>

#include "kernels/base/types.hpp"

namespace planish {

class Buffer {
 public:
  /// Room for `capacity` bytes, the old ones kept. False: no memory; nothing changed.
  bool reserve(std::size_t capacity);
  char* data() { return bytes_.get(); }
  std::size_t capacity() const { return capacity_; }
  void set_size(std::size_t size) { size_ = size; }
  std::size_t size() const { return size_; }
  std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  struct Free {
    void operator()(char* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<char, Free> bytes_;
  std::size_t capacity_ = 0, size_ = 0;
};

}  // namespace planish
