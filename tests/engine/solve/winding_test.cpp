#include "engine/solve/winding.hpp"

#include <doctest/doctest.h>

#include "engine/solve/map_energy.hpp"
#include "engine/solve/patches.hpp"
#include "tests/support/grid_map.hpp"

using namespace planish;

namespace {

std::vector<Vec2> squared(const std::vector<Vec2>& z) {
  std::vector<Vec2> result;
  for (const Vec2 p : z) result.push_back(multiply(p, p));
  return result;
}

std::vector<Vec2> turned(std::vector<Vec2> z, double angle) {
  for (Vec2& p : z) p = multiply(unit(angle), p);
  return z;
}

struct Case {
  GridMap map;
  ArapEnergy mesh = map.energy();
  Winding winding{map.exec, mesh};
  explicit Case(Mesh given) : map(std::move(given)) {}
  /// Without flips, which is proved.
  bool is_single(const std::vector<Vec2>& uv) const {
    REQUIRE(MapEnergy(map.exec, mesh).flipped(uv).empty());
    const bool single = winding.is_single(uv);
    CHECK(single == overwound_vertices(map.exec, mesh, uv).empty());
    return single;
  }
};

}  // namespace

TEST_CASE("winding: a fan that winds twice is told by its boundary, however it is turned") {
  const Case fan(flat_fan());
  const std::vector<Vec2> twice = squared(fan.map.flat);
  for (int k = 0; k < 24; ++k) {  // edges that are horizontal among them
    CHECK(fan.is_single(turned(fan.map.flat, k * kPi / 12)));
    CHECK_FALSE(fan.is_single(turned(twice, k * kPi / 12)));
  }
}

TEST_CASE(
    "winding: a grid of horizontal edges, and a ring that winds twice around its hole, wind once around "
    "vertices") {
  const Case grid(shapes::height_field(9, shapes::flat, 0));
  CHECK(grid.is_single(grid.map.flat));
  const Case around(shapes::frame(24, shapes::flat));
  CHECK(around.is_single(around.map.flat));
  CHECK(around.is_single(squared(around.map.flat)));
}

TEST_CASE("winding: patches, whose rims are open, wind once where their mesh does") {
  const GridMap grid(20);
  const ArapEnergy mesh = grid.energy();
  std::vector<std::uint8_t> movable(grid.rim.size());
  std::vector<Index> rank(grid.rim.size());
  for (std::size_t v = 0; v < movable.size(); ++v) movable[v] = !grid.rim[v], rank[v] = static_cast<Index>(v);
  for (const int rings : {0, 1, 2, 5}) {
    for (const Index seed : {0, 100, 371}) {
      for (const Patch& patch : grow_patches(mesh, std::vector<Index>{seed}, rings, movable, rank)) {
        const PatchMesh local(mesh, patch);
        std::vector<Vec2> uv;
        for (const Index v : patch.vertex) uv.push_back(grid.flat[v]);
        CHECK(Winding(grid.exec, local.energy()).is_single(uv));
      }
    }
  }
}
