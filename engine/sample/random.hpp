// Random numbers by counter: each depends on the seed and its own index only, so any thread can ask for any
// of them.
#pragma once

#include <cstdint>

namespace planish {

/// Uniform in [0, 1).
/// Ref: Steele, Lea, Flood 2014, splitmix64.
inline double counter_random(std::uint64_t seed, std::uint64_t index) {
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;
  const auto mix = [](std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  };
  return static_cast<double>(mix(mix(seed + kGolden) + (index + 1) * kGolden) >> 11) * 0x1p-53;
}

}  // namespace planish
