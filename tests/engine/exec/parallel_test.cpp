#include "engine/exec/parallel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <new>
#include <numeric>

#include "tests/support/shapes.hpp"

using namespace planish;

TEST_CASE("parallel: blocks cover every index once, for sizes around the block") {
  const Exec exec(3);
  for (const Index n : {0, 1, 9, 10, 11, 1000}) {
    std::vector<int> seen(n, 0);
    exec.for_blocks(n, 10, [&](Index block, Range r) {
      CHECK(r.begin == block * 10);
      for (Index i = r.begin; i < r.end; ++i) ++seen[i];
    });
    CHECK(std::all_of(seen.begin(), seen.end(), [](int s) { return s == 1; }));
  }
}

TEST_CASE("parallel: a sum over blocks has the same bits on 1, 2 and 7 threads") {
  std::vector<double> value(100'003);
  shapes::Random random(1);
  for (double& x : value) x = random.uniform() - 0.5;
  const auto sum = [&](int threads) {
    return Exec(threads).sum_blocks(static_cast<Index>(value.size()), 1000, [&](Range r) {
      return std::accumulate(value.begin() + r.begin, value.begin() + r.end, 0.0);
    });
  };
  CHECK(sum(2) == sum(1));
  CHECK(sum(7) == sum(1));
}

TEST_CASE("parallel: loops inside loops run all of their tasks, and both sides of a pair") {
  const Exec exec(3);
  std::vector<int> seen(20 * 30, 0);
  std::array<std::vector<int>, 2> side = {std::vector<int>(50), std::vector<int>(50)};
  const auto fill = [&](int k) {
    return [&exec, &side, k] { exec.for_tasks(50, [&](Index i) { ++side[k][i]; }); };
  };
  exec.for_tasks(20, [&](Index i) { exec.for_tasks(30, [&](Index j) { ++seen[30 * i + j]; }); });
  exec.both(fill(0), fill(1));
  CHECK(seen == std::vector<int>(seen.size(), 1));
  CHECK(side[0] == std::vector<int>(50, 1));
  CHECK(side[1] == std::vector<int>(50, 1));
}

TEST_CASE("parallel: what a task throws reaches the caller, and the next loop runs") {
  const Exec exec(3);
  const auto failing = [&] {
    exec.for_tasks(100, [](Index i) {
      if (i == 57) throw std::bad_alloc();
    });
  };
  CHECK_THROWS_AS(failing(), std::bad_alloc);
  CHECK_THROWS_AS(exec.both(failing, [] {}), std::bad_alloc);
  std::vector<int> seen(100, 0);
  exec.for_tasks(100, [&](Index i) { ++seen[i]; });
  CHECK(seen == std::vector<int>(100, 1));
}

TEST_CASE("parallel: sort_by_key is stable and agrees with std::stable_sort over several digits and blocks") {
  constexpr int kBits = 25;
  std::vector<KeyedIndex> items(300'000);
  shapes::Random random(2);
  for (Index i = 0; i < static_cast<Index>(items.size()); ++i) {
    items[i] = {random.bits() & ((1u << kBits) - 1) & ~0xFFull, i};  // many equal keys
  }
  auto expected = items;
  std::stable_sort(expected.begin(), expected.end(), [](auto& a, auto& b) { return a.key < b.key; });
  sort_by_key(Exec(2), items, kBits);
  const bool same = std::equal(items.begin(), items.end(), expected.begin(),
                               [](auto& a, auto& b) { return a.key == b.key && a.index == b.index; });
  CHECK(same);
}

TEST_CASE("parallel: bits_for holds the largest value below n") {
  CHECK(bits_for(1) == 1);
  CHECK(bits_for(2) == 1);
  CHECK(bits_for(3) == 2);
  CHECK(bits_for(1u << 20) == 20);
  CHECK(bits_for((1u << 20) + 1) == 21);
}
