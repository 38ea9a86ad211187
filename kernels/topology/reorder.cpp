#include "kernels/topology/reorder.hpp"

#include <algorithm>

namespace planish {
namespace {

std::uint32_t cell(double coordinate, double lower, double scale) {
  constexpr double kLast = (1 << kHilbertBits) - 1;
  const double c = (coordinate - lower) * scale;
  return std::isfinite(c) ? static_cast<std::uint32_t>(std::clamp(c, 0.0, kLast)) : 0;
}

}  // namespace

std::uint64_t hilbert_key(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint32_t axis[3] = {x, y, z};
  // Undo excess work of the Gray code from the top bit down, then Gray encode (Skilling's AxestoTranspose).
  for (std::uint32_t q = 1u << (kHilbertBits - 1); q > 1; q >>= 1) {
    const std::uint32_t p = q - 1;
    for (auto& a : axis) {
      if (a & q) {
        axis[0] ^= p;
      } else {
        const std::uint32_t t = (axis[0] ^ a) & p;
        axis[0] ^= t;
        a ^= t;
      }
    }
  }
  axis[1] ^= axis[0];
  axis[2] ^= axis[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = 1u << (kHilbertBits - 1); q > 1; q >>= 1) {
    if (axis[2] & q) t ^= q - 1;
  }
  std::uint64_t key = 0;
  for (int bit = kHilbertBits - 1; bit >= 0; --bit) {
    for (const std::uint32_t a : axis) key = key << 1 | (((a ^ t) >> bit) & 1);
  }
  return key;
}

void hilbert_keys(Range r, Vec3 lower, double extent, In<Vec3> position, Out<std::uint64_t> key) {
  const double scale = (1 << kHilbertBits) / extent;
  for (Index v = r.begin; v < r.end; ++v) {
    const Vec3 p = position[v];
    key[v] = hilbert_key(cell(p.x, lower.x, scale), cell(p.y, lower.y, scale), cell(p.z, lower.z, scale));
  }
}

}  // namespace planish
