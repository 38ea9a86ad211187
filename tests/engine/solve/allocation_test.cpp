#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "engine/solve/fill_reducing_order.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/workpiece.hpp"
#include "tests/support/shapes.hpp"

namespace {
std::atomic<long> allocations = 0;
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size);
  if (!memory) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace planish;

TEST_CASE("global phase: solves after the first take no memory, with a rounded factor too") {
  const Exec exec(2);
  const Mesh mesh = shapes::wavy_disk(60'000);
  Workpiece piece = *make_workpiece(exec, mesh.surface());
  std::vector<std::uint8_t> held(piece.mesh().num_vertices(), 0);
  held[0] = 1;
  const SymmetricMatrix laplacian = piece.held_laplacian(exec, held);
  const auto order = fill_reducing_order(exec, laplacian);
  REQUIRE(order);
  auto global = GlobalPhase::factor(exec, laplacian, *order);
  REQUIRE(global);
  std::vector<Vec2> x(laplacian.size(), Vec2{1, -1});
  for (const bool rounded : {false, true}) {
    if (rounded) global->round(exec);
    const long before = allocations;
    global->solve(exec, x, x);
    const long first = allocations;
    CHECK(first > before);
    for (int k = 0; k < 5; ++k) global->solve(exec, x, x);
    CHECK(allocations == first);
  }
}
