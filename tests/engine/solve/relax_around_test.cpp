// Neighbourhoods of a guessed map, relaxed.
#include "engine/solve/relax_around.hpp"

#include <doctest/doctest.h>

#include "engine/solve/map_energy.hpp"
#include "engine/workpiece.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

constexpr Index kSide = 31;

/// A flat square mapped to itself, its rim and its middle held, the middle moved away.
struct Dented {
  Exec exec;
  Mesh mesh = shapes::height_field(kSide, shapes::flat, 0);
  Workpiece piece;
  NodeMap nodes;
  Index middle = 0;
  std::vector<Vec2> uv;

  Dented(int threads, double edges) : exec(threads) {
    piece = *make_workpiece(exec, mesh.surface());
    const Index num_vertices = piece.mesh().num_vertices();
    piece.order = *fill_reducing_order(exec, piece.whole_laplacian(exec));
    Vec2 lower, upper;
    for (const Vec3 p : piece.mesh().position) {
      uv.push_back({p.x, p.y});
      lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
      upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
    }
    const Vec2 centre = 0.5 * (lower + upper);
    for (Index v = 0; v < num_vertices; ++v) {
      if (norm(uv[v] - centre) < norm(uv[middle] - centre)) middle = v;
    }
    uv[middle] += Vec2{edges * (upper.x - lower.x) / (kSide - 1), 0};
    nodes.num_nodes = num_vertices;
    for (Index v = 0; v < num_vertices; ++v) {
      const bool held = piece.topology().is_boundary(v) || v == middle;
      nodes.fixed.push_back(held);
      nodes.node.push_back(held ? kNone : v);
      if (held) nodes.place.emplace_back(v, uv[v]);
    }
  }
  double energy(const std::vector<Vec2>& z) {
    std::vector<Vec2> force(z.size());
    return LocalPhase(exec, piece.energy(nodes.fixed)).evaluate(z, force);
  }
  std::vector<Vec2> relaxed(int rings) {
    DofMap dof(nodes);
    auto global = GlobalPhase::analyse(exec, piece.whole_laplacian(exec), piece.order);
    REQUIRE(global.has_value());
    const ArapProblem arap = piece.problem(*global, nodes, dof, dof, {});
    std::vector<Vec2> z = uv;
    const Index around[] = {middle};
    REQUIRE(relax_around(exec, arap, around, rings, z).has_value());
    return z;
  }
};

}  // namespace

TEST_CASE("relax_around: the energy falls, what is held and what is farther than the rings stays") {
  Dented scene(0, 0.6);
  const std::vector<Vec2> wide = scene.relaxed(40), near = scene.relaxed(3);
  const double before = scene.energy(scene.uv);
  CHECK(scene.energy(near) < 0.9 * before);
  CHECK(scene.energy(wide) < scene.energy(near));
  CHECK(near[scene.middle] == scene.uv[scene.middle]);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < near.size(); ++v) {
    moved += near[v] != scene.uv[v];
    if (scene.nodes.fixed[v]) CHECK(wide[v] == scene.uv[v]);
  }
  CHECK(moved > 6);
  CHECK(moved < 120);
}

TEST_CASE("relax_around: with all around it two steps come near to where no force is left") {
  Dented scene(0, 0.3);
  std::vector<Vec2> force(scene.uv.size());
  LocalPhase local(scene.exec, scene.piece.energy(scene.nodes.fixed));
  const auto largest_force = [&](const std::vector<Vec2>& z) {
    local.evaluate(z, force);
    double most = 0;
    for (const Vec2 f : force) most = std::max(most, norm(f));
    return most;
  };
  CHECK(largest_force(scene.relaxed(40)) < 0.01 * largest_force(scene.uv));
}

TEST_CASE("relax_around: a neighbourhood with flips stays as it is") {
  Dented scene(0, 2.5);
  CHECK(scene.relaxed(5) == scene.uv);
}

TEST_CASE("relax_around: 1, 2 and 7 threads give the same bits") {
  const std::vector<Vec2> one = Dented(1, 0.6).relaxed(10);
  CHECK(Dented(2, 0.6).relaxed(10) == one);
  CHECK(Dented(7, 0.6).relaxed(10) == one);
}
