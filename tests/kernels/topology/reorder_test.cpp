#include "kernels/topology/reorder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

using namespace planish;

TEST_CASE("reorder: along the Hilbert curve consecutive cells of a full cube are neighbours") {
  constexpr std::uint32_t kEdge = 8;
  std::vector<std::pair<std::uint64_t, std::array<std::uint32_t, 3>>> cells;
  for (std::uint32_t x = 0; x < kEdge; ++x) {
    for (std::uint32_t y = 0; y < kEdge; ++y) {
      for (std::uint32_t z = 0; z < kEdge; ++z) cells.push_back({hilbert_key(x, y, z), {x, y, z}});
    }
  }
  std::sort(cells.begin(), cells.end());
  for (std::size_t i = 0; i < cells.size(); ++i) CHECK(cells[i].first == i);
  for (std::size_t i = 1; i < cells.size(); ++i) {
    unsigned steps = 0;
    for (int k = 0; k < 3; ++k) {
      steps += static_cast<unsigned>(
          std::abs(static_cast<int>(cells[i].second[k]) - static_cast<int>(cells[i - 1].second[k])));
    }
    CHECK(steps == 1);
  }
}

TEST_CASE("reorder: a position that is not finite counts as the corner of the box") {
  const std::vector<Vec3> position = {{0, 0, 0}, {std::nan(""), 0, 0}, {0.9, 0.9, 0.9}};
  std::vector<std::uint64_t> key(3);
  hilbert_keys({0, 3}, {0, 0, 0}, 1, position, key);
  CHECK(key[0] == key[1]);
  CHECK(key[2] != key[0]);
}
