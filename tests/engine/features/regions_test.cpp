#include "engine/features/regions.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

Result<std::vector<Index>> region(const Mesh& mesh, std::vector<Index> triangles) {
  const Topology topology = build_topology(Exec(1), mesh.surface());
  return region_of_triangles(mesh.surface(), topology, "patch", {std::move(triangles)});
}

void check_error(const Result<std::vector<Index>>& result, ErrorCode code, std::vector<Index> ids,
                 Offset count) {
  REQUIRE(!result);
  CHECK(result.error().code == code);
  CHECK(result.error().ids == ids);
  CHECK(result.error().count == count);
  CHECK(result.error().what.find("feature \"patch\"") == 0);
}

}  // namespace

TEST_CASE("regions: connected triangles come back ascending") {
  std::vector<Index> all(32);
  std::iota(all.rbegin(), all.rend(), 0);
  const std::vector<Index> found = region(shapes::height_field(5, shapes::flat, 0), all).value();
  CHECK(found.size() == 32);
  CHECK(std::is_sorted(found.begin(), found.end()));
  CHECK(region(shapes::cube(1), {7}).value() == std::vector<Index>{7});
}

TEST_CASE("regions: none, out of range and repeated triangles are refused with the ids") {
  const Mesh cube = shapes::cube(1);
  check_error(region(cube, {}), ErrorCode::RegionBroken, {}, 0);
  check_error(region(cube, {1, 12, 2, -3}), ErrorCode::RegionBroken, {12, -3}, 2);
  check_error(region(cube, {5, 1, 5, 0, 5, 0}), ErrorCode::RegionBroken, {0, 5}, 2);
}

TEST_CASE("regions: pieces that share no edge are counted, each named by its first triangle") {
  // A row of cells, two triangles each; the pieces 0-1, 4-5 and 6 touch in vertices at most.
  const Mesh mesh = shapes::height_field(5, shapes::flat, 0);
  check_error(region(mesh, {5, 4, 1, 0}), ErrorCode::RegionBroken, {0, 4}, 2);
  check_error(region(shapes::joined(mesh, mesh), {32, 3, 33, 2}), ErrorCode::RegionBroken, {2, 32}, 2);
  std::vector<Index> scattered;
  for (Index t = 0; t < 3000; t += 4) scattered.push_back(t);
  const auto many = region(shapes::height_field(41, shapes::flat, 0), scattered);
  REQUIRE(!many);
  CHECK(many.error().count == 750);
  CHECK(many.error().ids.size() == kMaxListedIds);
}
