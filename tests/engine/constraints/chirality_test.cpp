#include "engine/constraints/chirality.hpp"

#include "tests/engine/constraints/rest.hpp"

using namespace planish;
using namespace planish::tests;

namespace {

std::vector<Index> reversed(std::vector<Index> chain) {
  std::reverse(chain.begin(), chain.end());
  return chain;
}

/// A boundary loop with the surface on its left.
std::vector<Index> loop_vertices(const Rest& rest, Index loop) {
  std::vector<Index> chain;
  for (const Index c : slice(In<Index>(rest.topology().loop_corner), rest.topology().loops().group(loop)))
    chain.push_back(rest.mesh().corner_vertex[c]);
  return chain;
}

}  // namespace

TEST_CASE("chirality: the outer loop runs counter-clockwise with the surface on its left, a hole clockwise") {
  const Rest rest(shapes::frame(13, shapes::flat));
  Chirality chirality(rest.surface);
  const Index hole = 1 - rest.outer[0];
  CHECK(chirality.counter_clockwise(loop_vertices(rest, rest.outer[0])) == true);
  CHECK(chirality.counter_clockwise(reversed(loop_vertices(rest, rest.outer[0]))) == false);
  CHECK(chirality.counter_clockwise(loop_vertices(rest, hole)) == false);
  CHECK(chirality.counter_clockwise(reversed(loop_vertices(rest, hole))) == true);
}

TEST_CASE("chirality: an interior chain has the side without the outer loop inside, wherever it lies") {
  const Index n = 12;
  const Rest rest(shapes::wavy_disk(2 * (n - 1) * (n - 1)));
  Chirality chirality(rest.surface);
  // In the middle, at the boundary (three of its sides run along it), almost the whole, and a single cell.
  for (const auto& box : {std::array<Index, 4>{3, 3, 8, 7}, {0, 0, 11, 6}, {1, 1, 10, 10}, {5, 5, 6, 6}}) {
    const Feature chain = rest.chain("loop", grid_loop(n, box[0], box[1], box[2], box[3]), true);
    CHECK(chirality.counter_clockwise(chain.vertex) == true);
    CHECK(chirality.counter_clockwise(reversed(chain.vertex)) == false);
  }
}

TEST_CASE("chirality: around a hole the hole is inside, and where the hole is the outer loop the rest is") {
  Rest rest(polar_mesh(4, 24, 1, 2, 2 * kPi));
  std::vector<Index> ring(24);
  std::iota(ring.begin(), ring.end(), 48);
  const Feature chain = rest.chain("ring", ring, true);
  CHECK(Chirality(rest.surface).counter_clockwise(chain.vertex) == true);
  rest.outer[0] = 1 - rest.outer[0];
  CHECK(Chirality(rest.surface).counter_clockwise(chain.vertex) == false);
}

TEST_CASE("chirality: a chain that does not part the surface has none") {
  Mesh torus = shapes::torus(12);
  torus.corner_vertex.erase(torus.corner_vertex.begin(), torus.corner_vertex.begin() + 3);  // a boundary
  const Rest rest(torus);
  std::vector<Index> meridian, circle = grid_loop(12, 4, 4, 8, 8);
  for (Index j = 0; j < 12; ++j) meridian.push_back(12 * j + 6);
  Chirality chirality(rest.surface);
  CHECK_FALSE(chirality.counter_clockwise(rest.chain("m", meridian, true).vertex).has_value());
  CHECK(chirality.counter_clockwise(rest.chain("c", circle, true).vertex).has_value());
}

TEST_CASE("chirality: the mean normal beside a chain is the surface's, inside and at the boundary") {
  const Index n = 9;
  const Rest rest(shapes::height_field(n, [](double x, double y) { return 0.5 * x + 0.25 * y; }));
  const Vec3 up = {-0.5, -0.25, 1}, normal = (1 / norm(up)) * up;
  for (const auto& path : {grid_path(n, 2, 3, 6, 3), grid_path(n, 0, 0, 8, 0)})
    CHECK(norm(mean_normal(rest.surface, rest.chain("c", path).vertex, false) - normal) < 1e-13);
  CHECK(norm(mean_normal(rest.surface, rest.chain("c", grid_loop(n, 2, 2, 5, 5), true).vertex, true) -
             normal) < 1e-13);
}

TEST_CASE("chirality: doubled area is positive counter-clockwise, and does not depend on the place") {
  std::vector<Vec2> square = {{1e6, 1e6}, {1e6 + 2, 1e6}, {1e6 + 2, 1e6 + 3}, {1e6, 1e6 + 3}};
  CHECK(doubled_area(square) == 12);
  std::reverse(square.begin(), square.end());
  CHECK(doubled_area(square) == -12);
}
