#include "io/outline.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace planish {
namespace {

TEST_CASE("outline: a square of two triangles has one closed boundary and one inner edge") {
  const std::vector<Index> corner_vertex{0, 1, 2, 0, 2, 3};
  const Outline outline = find_outline(Exec(), corner_vertex, 4);
  REQUIRE(outline.boundary.size() == 1);
  CHECK(outline.boundary[0] == std::vector<Index>{0, 1, 2, 3, 0});
  REQUIRE(outline.inner.size() == 1);
  CHECK(outline.inner[0] == 2);  // 2 -> 0 of the first triangle
  CHECK(outline.twin[2] == 3);
}

TEST_CASE("outline: two triangles that touch in a vertex have all six edges on their boundary") {
  const std::vector<Index> corner_vertex{0, 1, 2, 2, 3, 4};
  const Outline outline = find_outline(Exec(), corner_vertex, 5);
  std::size_t edges = 0;
  for (const auto& chain : outline.boundary) edges += chain.size() - 1;
  CHECK(edges == 6);
  CHECK(outline.inner.empty());
}

TEST_CASE("outline: a closed surface has no boundary and each edge once") {
  const std::vector<Index> tetrahedron{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  const Outline outline = find_outline(Exec(), tetrahedron, 4);
  CHECK(outline.boundary.empty());
  CHECK(outline.inner.size() == 6);
}

TEST_CASE("outline: an edge of three triangles is drawn and is no boundary") {
  const std::vector<Index> corner_vertex{0, 1, 2, 1, 0, 3, 0, 1, 4};
  const Outline outline = find_outline(Exec(), corner_vertex, 5);
  CHECK(std::ranges::count(outline.inner, 0) == 1);
  std::size_t edges = 0;
  for (const auto& chain : outline.boundary) edges += chain.size() - 1;
  CHECK(edges == 6);
}

TEST_CASE("outline: no triangles have no edges") {
  const Outline outline = find_outline(Exec(), {}, 3);
  CHECK(outline.boundary.empty());
  CHECK(outline.inner.empty());
}

}  // namespace
}  // namespace planish
