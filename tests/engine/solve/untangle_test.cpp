#include "engine/solve/untangle.hpp"

#include <doctest/doctest.h>

#include <random>

#include "engine/solve/patch_work.hpp"
#include "engine/solve/patches.hpp"
#include "engine/solve/tutte.hpp"
#include "tests/support/grid_map.hpp"

using namespace planish;

TEST_CASE("untangling: a square whose inner vertices are anywhere is laid out without flips") {
  const GridMap grid(30);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const ArapEnergy energy = grid.energy();
    NewtonMap map(grid.exec, energy, grid.inner(), nullptr, grid.scattered(seed));
    REQUIRE(map.measure().flipped(map.uv()).size() > 50);
    Untangling untangling(map, 100);
    while (!untangling.is_done()) REQUIRE(untangling.step());
    CHECK(untangling.is_positive());
    CHECK(map.measure().is_injective(map.uv()));
    // And down to the isometry that the rim allows.
    map.lower({.kind = MapDensity::Kind::SymmetricDirichlet});
    Descent descent(map, 1e-9, 100);
    double energy_before = map.energy();
    while (!descent.is_done()) {
      REQUIRE(descent.step());
      CHECK(map.energy() <= energy_before * (1 + 1e-12));
      CHECK(map.measure().is_injective(map.uv()));
      energy_before = map.energy();
    }
    CHECK(descent.has_converged());
    for (std::size_t v = 0; v < grid.flat.size(); ++v) CHECK(norm(map.uv()[v] - grid.flat[v]) < 1e-6);
  }
}

TEST_CASE("descent: with factors kept it ends where Newton steps alone do, after fewer factorizations") {
  const GridMap grid(shapes::height_field(
      31, [](double x, double y) { return 0.3 * std::sin(5 * x) * std::cos(4 * y); }, 0));
  const ArapEnergy energy = grid.energy();
  const MapDensity density{.kind = MapDensity::Kind::SymmetricDirichlet};
  std::vector<Vec2> start = grid.flat;
  for (Index v = 0; v < static_cast<Index>(start.size()); ++v) {
    if (!grid.rim[v]) start[v] = start[v] + 0.6 * (start[grid.inner().vertex.front()] - start[v]);
  }
  NewtonMap alone(grid.exec, energy, grid.inner(), nullptr, start);
  REQUIRE(alone.measure().is_injective(start));
  alone.lower(density);
  int factorizations = 0;
  do {
    REQUIRE(alone.prepare());
    ++factorizations;
  } while (alone.gradient() > 1e-9 && alone.advance());
  REQUIRE(alone.gradient() <= 1e-9);

  NewtonMap map(grid.exec, energy, grid.inner(), nullptr, start);
  map.lower(density);
  Descent descent(map, 1e-9, 100);
  int steps = 0;
  double before = map.energy();
  for (; !descent.is_done(); ++steps) {
    REQUIRE(descent.step());
    CHECK(map.energy() <= before * (1 + 1e-12));
    before = map.energy();
  }
  CHECK(descent.has_converged());
  CHECK(descent.steps() < factorizations);
  CHECK(steps > descent.steps());
  for (std::size_t v = 0; v < start.size(); ++v) CHECK(norm(map.uv()[v] - alone.uv()[v]) < 1e-7);
}

TEST_CASE("map energy: forces are half the central differences of the energy") {
  const GridMap grid(4);
  const ArapEnergy mesh = grid.energy();
  MapEnergy energy(grid.exec, mesh);
  std::vector<Vec2> x = grid.flat, force(x.size()), other(x.size());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> change(-0.02, 0.02);
  for (Vec2& z : x) z += Vec2{change(random), change(random)};
  for (const auto kind :
       {MapDensity::Kind::Arap, MapDensity::Kind::SymmetricDirichlet, MapDensity::Kind::Untangling}) {
    const MapDensity density{.kind = kind, .epsilon = 0.1};
    energy.evaluate(density, x, force);
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (grid.rim[v]) {
        CHECK(force[v] == Vec2{});
        continue;
      }
      constexpr double kStep = 1e-6;
      std::vector<Vec2> before = x, after = x;
      before[v].x -= kStep, after[v].x += kStep;
      const double slope =
          (energy.evaluate(density, after, other) - energy.evaluate(density, before, other)) / (2 * kStep);
      CHECK(std::abs(2 * force[v].x - slope) < 1e-6 * (1 + std::abs(slope)));
    }
  }
}

TEST_CASE("map energy: every triangle of a mirrored map is flipped") {
  const GridMap grid(6);
  const ArapEnergy mesh = grid.energy();
  const MapEnergy energy(grid.exec, mesh);
  CHECK(energy.is_injective(grid.flat));
  std::vector<Vec2> mirrored = grid.flat;
  for (Vec2& z : mirrored) z.x = -z.x;
  CHECK(static_cast<Index>(energy.flipped(mirrored).size()) == mesh.num_triangles());
  CHECK(overwound_vertices(grid.exec, mesh, grid.flat).empty());
}

TEST_CASE("map energy: a fan that winds twice is overwound though every triangle is positive") {
  const GridMap wheel(flat_fan());
  const ArapEnergy mesh = wheel.energy();
  const MapEnergy energy(wheel.exec, mesh);
  CHECK(energy.is_injective(wheel.flat));
  const Index hub = wheel.inner().vertex.front();
  std::vector<Vec2> wound = wheel.flat;
  for (std::size_t v = 0; v < wound.size(); ++v) {
    const Vec2 spoke = wheel.flat[v] - wheel.flat[hub];
    wound[v] = multiply(spoke, spoke);
  }
  CHECK(energy.flipped(wound).empty());
  CHECK(overwound_vertices(wheel.exec, mesh, wound) == std::vector<Index>{hub});
  CHECK(!energy.is_injective(wound));
}

TEST_CASE("patches: they do not touch, hold their rims, and have the energy of their triangles") {
  const GridMap grid(30);
  const ArapEnergy mesh = grid.energy();
  std::vector<std::uint8_t> movable(grid.rim.size());
  std::vector<Index> rank(grid.rim.size());
  for (std::size_t v = 0; v < movable.size(); ++v) movable[v] = !grid.rim[v];
  for (std::size_t k = 0; k < rank.size(); ++k) rank[grid.piece.order[k]] = static_cast<Index>(k);
  const std::vector<Index> seeds = {0, mesh.num_triangles() / 2, mesh.num_triangles() - 1};
  const std::vector<Patch> patches = grow_patches(mesh, seeds, 2, movable, rank);
  CHECK(patches.size() >= 2);
  std::vector<Index> patch_of(grid.rim.size(), kNone);
  for (std::size_t k = 0; k < patches.size(); ++k) {
    for (Index i = 0; i < patches[k].num_free; ++i) {
      const Index v = patches[k].vertex[i];
      CHECK(!grid.rim[v]);
      CHECK(patch_of[v] == kNone);
      patch_of[v] = static_cast<Index>(k);
    }
  }
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    Index here = kNone;
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const Index p = patch_of[mesh.corner_vertex[c]];
      if (p == kNone) continue;
      CHECK((here == kNone || here == p));
      here = p;
    }
  }
  const PatchMesh local(mesh, patches[0]);
  std::vector<Vec2> x = grid.flat, here;
  for (Vec2& z : x) z = {z.x + 0.1 * z.y * z.y, 1.1 * z.y};
  for (const Index v : patches[0].vertex) here.push_back(x[v]);
  MapEnergy whole(grid.exec, mesh), part(grid.exec, local.energy());
  std::vector<Vec2> force(x.size()), local_force(here.size());
  const MapDensity density{.kind = MapDensity::Kind::SymmetricDirichlet};
  whole.evaluate(density, x, force);
  part.evaluate(density, here, local_force);
  for (Index i = 0; i < patches[0].num_free; ++i)
    CHECK(norm(local_force[i] - force[patches[0].vertex[i]]) < 1e-12);
}

TEST_CASE(
    "newton map: of what is compressed and held around the first, projected step is as good as Newton's "
    "own") {
  const GridMap grid(10);
  const ArapEnergy mesh = grid.energy();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> change(-1e-4, 1e-4);
  std::vector<Vec2> x;
  for (std::size_t v = 0; v < grid.flat.size(); ++v) {
    x.push_back(0.7 * grid.flat[v]);
    if (!grid.rim[v]) x.back() += Vec2{change(random), change(random)};
  }
  NewtonMap map(grid.exec, mesh, grid.inner(), nullptr, x);
  map.lower({});
  REQUIRE(map.prepare());
  const double before = map.gradient();
  REQUIRE(map.advance());
  REQUIRE(map.prepare());
  CHECK(map.gradient() < 1e-2 * before);
}

TEST_CASE("tutte: a crumpled surface has a map without flips") {
  GridMap grid(15);
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  Mesh crumpled = grid.mesh;
  for (Vec3& p : crumpled.position) p = {normal(random), normal(random), normal(random)};
  Workpiece piece = *make_workpiece(grid.exec, crumpled.surface());
  piece.outer_loop = {0};
  piece.order = grid.piece.order;
  const auto uv = tutte_map(grid.exec, piece.start_input());
  REQUIRE(uv.has_value());
  const NodeMap nodes = find_nodes(piece.component, 1);
  CHECK(MapEnergy(grid.exec, piece.energy(nodes.fixed)).is_injective(*uv));
}
