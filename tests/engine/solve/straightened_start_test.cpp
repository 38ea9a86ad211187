#include "engine/solve/straightened_start.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "engine/solve/boundary_barrier.hpp"
#include "engine/solve/map_energy.hpp"
#include "engine/verify/overlaps.hpp"
#include "engine/workpiece.hpp"

using namespace planish;

namespace {

constexpr Index kSide = 40, kDeep = 4;

/// A flat square of cells of size 1, x from -20.5 to 20.5, y from 0 up, with a slot of one cell's width in the middle of its lower
/// edge.
Mesh slotted() {
  Mesh mesh;
  const Index row = kSide + 2;
  const auto x = [](Index i) { return i - 0.5 * (kSide + 1); };
  std::vector<Index> number;
  for (Index j = 0; j <= kSide; ++j) {
    for (Index i = 0; i < row; ++i) mesh.position.push_back({x(i), double(j), 0});
  }
  for (Index j = 0; j < kSide; ++j) {
    for (Index i = 0; i + 1 < row; ++i) {
      if (2 * i == kSide && j < kDeep) continue;
      const Index a = j * row + i, d = a + row;
      for (const Index v : {a, a + 1, d + 1, a, d + 1, d}) mesh.corner_vertex.push_back(v);
    }
  }
  return mesh;
}

/// Both sides of the slot are moved across its middle.
Vec2 closed(Vec2 p) {
  const double near = std::max(0.0, 1 - std::abs(p.x) / 9) * std::max(0.0, 1 - p.y / kDeep);
  return {p.x - std::copysign(0.8, p.x) * near, p.y};
}

Mesh curled_at_rest() {
  Mesh mesh = slotted();
  for (Vec3& p : mesh.position) {
    const Vec2 z = closed({p.x, p.y});
    p = {z.x, z.y, 0};
  }
  return mesh;
}

/// A map whose sides of the slot overlap; where they do so at rest too, it has no energy.
struct Curled {
  Exec exec{2};
  Mesh mesh;
  Workpiece piece = *make_workpiece(exec, mesh.surface());
  NodeMap nodes = find_nodes(piece.component, 1);
  DofMap dof{nodes};
  std::vector<Vec2> uv;
  ArapProblem problem{.energy = piece.energy(nodes.fixed),
                      .topology = &piece.topology(),
                      .edge_weight = {},
                      .dof = &dof,
                      .rotation = {},
                      .order = {},
                      .vertex_component = piece.component,
                      .turns_freely = {1}};

  explicit Curled(bool at_rest = false) : mesh(at_rest ? curled_at_rest() : slotted()) {
    piece.order = *fill_reducing_order(exec, piece.whole_laplacian(exec));
    problem.order = piece.order;
    for (const Index v : piece.mesh().vertex_origin) {
      const Vec2 z{mesh.position[v].x, mesh.position[v].y};
      uv.push_back((1 / piece.mesh().unit) * (at_rest ? z : closed(z)));
    }
  }
  std::vector<Index> overlapping(In<Vec2> at) const {
    return overlapping_triangles(exec, piece.mesh().corner_vertex, at);
  }
  Result<std::optional<std::vector<Vec2>>> straightened(int& steps) const {
    return straighten_boundary(
        exec, problem, MapDensity{}, [&](In<Vec2> at) { return overlapping(at); }, {}, uv, steps);
  }
};

}  // namespace

TEST_CASE(
    "straightened start: sides of a slot that lie on one another are laid open, what is far from them "
    "stays") {
  Curled curled;
  MapEnergy measure(curled.exec, curled.problem.energy);
  REQUIRE(measure.is_injective(curled.uv));
  REQUIRE_FALSE(curled.overlapping(curled.uv).empty());
  int steps = 0;
  const auto straight = curled.straightened(steps);
  REQUIRE(straight.has_value());
  REQUIRE(straight->has_value());
  CHECK(steps > 0);
  CHECK(curled.overlapping(**straight).empty());
  CHECK(measure.is_injective(**straight));
  Index moved = 0, far = 0;
  for (std::size_t v = 0; v < curled.uv.size(); ++v) {
    const bool stays = (**straight)[v] == curled.uv[v];
    const bool is_far = curled.mesh.position[curled.piece.mesh().vertex_origin[v]].y > kDeep + 20;
    if (is_far) CHECK(stays);
    far += is_far;
    moved += !stays;
  }
  CHECK(moved > 8);
  CHECK(far > static_cast<Index>(curled.uv.size()) / 4);
}

TEST_CASE("straightened start: a flat slot comes back to rest, its sides kept apart on the way") {
  Curled curled;
  const BoundaryBarrier barrier(curled.exec, curled.problem.energy, curled.piece.topology(),
                                curled.piece.component);
  curled.problem.barrier = &barrier;
  int steps = 0;
  const auto straight = curled.straightened(steps);
  REQUIRE(straight.has_value());
  REQUIRE(straight->has_value());
  MapEnergy measure(curled.exec, curled.problem.energy);
  std::vector<Vec2> force(curled.uv.size());
  CHECK(measure.evaluate({}, **straight, force) < 1e-7 * curled.problem.energy.area);
  CHECK(measure.evaluate({}, curled.uv, force) > 1e-4 * curled.problem.energy.area);
  CHECK(curled.overlapping(**straight).empty());
}

TEST_CASE("straightened start: sides that overlap at rest are kept apart on their way back") {
  Curled curled(true);
  const BoundaryBarrier barrier(curled.exec, curled.problem.energy, curled.piece.topology(),
                                curled.piece.component);
  curled.problem.barrier = &barrier;
  REQUIRE_FALSE(curled.overlapping(curled.uv).empty());
  int steps = 0;
  const auto straight = curled.straightened(steps);
  REQUIRE(straight.has_value());
  REQUIRE(straight->has_value());
  CHECK(curled.overlapping(**straight).empty());
  CHECK(MapEnergy(curled.exec, curled.problem.energy).is_injective(**straight));
}

TEST_CASE("straightened start: there is none where the boundary around the overlap is held") {
  Curled curled;
  NodeMap held = curled.nodes;
  for (const Index c : curled.piece.topology().loop_corner) {
    const Index v = curled.piece.mesh().corner_vertex[c];
    held.fixed[v] = 1;
    held.node[v] = kNone;
  }
  DofMap dof(held);
  curled.problem.dof = &dof;
  curled.problem.energy.fixed = held.fixed;
  int steps = 0;
  const auto straight = curled.straightened(steps);
  REQUIRE(straight.has_value());
  CHECK_FALSE(straight->has_value());
}
