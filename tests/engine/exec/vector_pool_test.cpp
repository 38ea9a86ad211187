#include "engine/exec/vector_pool.hpp"

#include <doctest/doctest.h>

using namespace planish;

TEST_CASE(
    "vector pool: what was given is taken again, of the size asked for, and copies are as their originals") {
  VectorPool pool;
  std::vector<Vec2> first = pool.take(100);
  CHECK(first == std::vector<Vec2>(100));
  first.assign(100, {1, 2});
  const Vec2* memory = first.data();
  pool.give(std::move(first));
  std::vector<Vec2> second = pool.take(50);
  CHECK(second.data() == memory);
  CHECK(second.size() == 50);
  const std::vector<Vec2> original(70, {3, 4});
  pool.give(std::move(second));
  const std::vector<Vec2> copy = pool.copy(original);
  CHECK(copy == original);
  CHECK(copy.data() == memory);
  CHECK(pool.take(10) == std::vector<Vec2>(10));
}
