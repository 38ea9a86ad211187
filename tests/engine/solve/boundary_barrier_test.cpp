#include "engine/solve/boundary_barrier.hpp"

#include <doctest/doctest.h>

#include "engine/solve/untangle.hpp"
#include "tests/support/grid_map.hpp"

using namespace planish;

namespace {

/// A flat frame around a square hole, cut open on one side by a slit of a given width: its ends face one another.
struct OpenFrame {
  Exec exec{2};
  Mesh mesh;
  Workpiece piece;
  NodeMap nodes;
  std::vector<Vec2> flat;

  explicit OpenFrame(double slit) {
    constexpr Index kSide = 8, kAcross = 2;  // quads along one side, and across
    // Columns run once around; the last one stops short of the first.
    const std::array<Vec2, 5> corner{Vec2{0, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
    std::vector<Vec2> way;
    for (std::size_t side = 0; side < 5; ++side) {
      const Vec2 from = corner[side], to = side == 4 ? Vec2{-slit, -1} : corner[side + 1];
      for (Index i = 0; i < kSide; ++i) way.push_back(from + (static_cast<double>(i) / kSide) * (to - from));
    }
    way.push_back({-slit, -1});
    for (const Vec2 z : way) {
      for (Index j = 0; j <= kAcross; ++j) {
        const double share = 1 - 0.2 * j;
        mesh.position.push_back(
            {z.y == -1 ? z.x * (std::abs(z.x) > slit ? share : 1) : z.x * share, z.y * share, 0});
      }
    }
    constexpr Index kRow = kAcross + 1;
    for (Index i = 0; i + 1 < static_cast<Index>(way.size()); ++i) {
      for (Index j = 0; j < kAcross; ++j) {
        const Index a = i * kRow + j, b = a + kRow;
        for (const Index v : {a, b, b + 1, a, b + 1, a + 1}) mesh.corner_vertex.push_back(v);
      }
    }
    piece = *make_workpiece(exec, mesh.surface());
    nodes = find_nodes(piece.component, 1);
    for (const Vec3 p : piece.mesh().position) flat.push_back({p.x, p.y});
  }

  ArapEnergy energy() const { return piece.energy(nodes.fixed); }
  BoundaryBarrier barrier() const { return {exec, energy(), piece.topology(), piece.component}; }
  /// Vertices of the end that closes the slit, and where it is put; x, y in the mesh's units.
  bool is_last(Index v) const {
    const double x = piece.mesh().position[v].x * piece.mesh().unit;
    return x < 0 && x > -0.06;
  }
  void put_last(double x, double dy) {
    const double unit = piece.mesh().unit;
    for (Index v = 0; v < static_cast<Index>(flat.size()); ++v) {
      if (is_last(v)) flat[v] = {x / unit, flat[v].y + dy / unit};
    }
  }
  double energy_at(const std::vector<Vec2>& uv) const {
    std::vector<Vec2> force(uv.size());
    return barrier().add_forces(uv, force);
  }
};

}  // namespace

TEST_CASE("boundary barrier: a map whose boundary keeps clear of itself has no energy") {
  const OpenFrame wide(0.05);
  CHECK(wide.energy_at(wide.flat) == 0);
  CHECK(wide.barrier().hessian(wide.flat, 1).empty());
}

TEST_CASE("boundary barrier: its energy grows without bound as ends come to touch") {
  double before = 0;
  for (const double slit : {0.02, 0.01, 0.005, 1e-4, 1e-6}) {
    // At rest the ends are far apart; the map closes the slit.
    OpenFrame frame(0.05);
    frame.put_last(-slit, 0);
    const double now = frame.energy_at(frame.flat);
    CHECK(now > before);
    before = now;
  }
  CHECK(before > 1e-3);
}

TEST_CASE("boundary barrier: forces and Hessians are those of central differences") {
  OpenFrame frame(0.05);
  frame.put_last(-0.007, 0.013);
  const BoundaryBarrier barrier = frame.barrier();
  const auto n = static_cast<Index>(frame.flat.size());
  std::vector<Vec2> force(n);
  REQUIRE(barrier.add_forces(frame.flat, force) > 0);
  std::vector<double> dense(4 * static_cast<std::size_t>(n) * n, 0);
  const auto at = [&](Index i, Index k) -> double& { return dense[static_cast<std::size_t>(i) * 2 * n + k]; };
  const std::vector<HessianElement> elements = barrier.hessian(frame.flat, 0);
  for (const HessianElement& e : elements) {
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Mat2& m = e.block[i][k];
        const Index row = 2 * e.vertex[i], column = 2 * e.vertex[k];
        at(row, column) += m.m00;
        at(row, column + 1) += m.m01;
        at(row + 1, column) += m.m10;
        at(row + 1, column + 1) += m.m11;
      }
    }
  }
  constexpr double kStep = 1e-7;
  int checked = 0;
  for (Index k = 0; k < 2 * n; ++k) {
    if (frame.nodes.fixed[k / 2]) continue;
    const auto moved = [&](double by) {
      std::vector<Vec2> uv = frame.flat;
      (k % 2 == 0 ? uv[k / 2].x : uv[k / 2].y) += by;
      return uv;
    };
    std::vector<Vec2> before(n), after(n);
    const double e0 = barrier.add_forces(moved(-kStep), before), e1 = barrier.add_forces(moved(kStep), after);
    const double slope = (e1 - e0) / (2 * kStep), exact = 2 * (k % 2 == 0 ? force[k / 2].x : force[k / 2].y);
    CHECK(std::abs(slope - exact) < 1e-6 * (1 + std::abs(exact)));
    for (Index i = 0; i < 2 * n; ++i) {
      if (frame.nodes.fixed[i / 2]) continue;
      const Vec2 d = (0.5 / kStep) * (after[i / 2] - before[i / 2]);
      const double difference = i % 2 == 0 ? d.x : d.y;
      CHECK(std::abs(difference - at(i, k)) < 1e-5 * (1 + std::abs(at(i, k))));
      checked += at(i, k) != 0;
    }
  }
  CHECK(checked > 30);
}

TEST_CASE("boundary barrier: pairs are among those that are near, and steps end at the first contact") {
  const OpenFrame frame(0.05);
  const BoundaryBarrier barrier = frame.barrier();
  std::vector<Vec2> direction(frame.flat.size());
  for (std::size_t v = 0; v < direction.size(); ++v) {
    if (frame.is_last(static_cast<Index>(v))) direction[v] = (1 / frame.piece.mesh().unit) * Vec2{1, 0.001};
  }
  CHECK(barrier.first_contact(frame.flat, direction, 1) == doctest::Approx(0.05).epsilon(1e-3));
  CHECK(barrier.first_contact(frame.flat, direction, 0.04) == kInfinity);
  std::vector<Vec2> closed = frame.flat;
  for (std::size_t v = 0; v < closed.size(); ++v) closed[v] += 0.0499 * direction[v];
  const auto near = barrier.near(closed);
  const auto elements = barrier.hessian(closed, 1);
  CHECK(elements.size() > 2);
  for (const HessianElement& e : elements) CHECK(std::binary_search(near.begin(), near.end(), e.vertex));
}

TEST_CASE("boundary barrier: that of a part has the energy and the forces between the edges that lie in it") {
  OpenFrame frame(0.05);
  frame.put_last(-1e-3, 2e-3);
  const ArapEnergy mesh = frame.energy();
  const auto n = static_cast<Index>(frame.flat.size());
  const BoundaryBarrier whole = frame.barrier();
  std::vector<Vec2> force(n);
  const double energy = whole.add_forces(frame.flat, force);
  REQUIRE(energy > 0);
  // All vertices in another order, and those of one end with the rest of the boundary missing.
  std::vector<Index> backwards, one_end;
  for (Index v = n; v-- > 0;) backwards.push_back(v);
  for (Index v = 0; v < n; ++v) {
    if (frame.is_last(v)) one_end.push_back(v);
  }
  const auto part_energy = [&](In<Index> vertex, std::vector<Vec2>& force_there) {
    std::vector<std::uint8_t> fixed;
    std::vector<Vec2> uv;
    for (const Index v : vertex) {
      fixed.push_back(mesh.fixed[v]);
      uv.push_back(frame.flat[v]);
    }
    ArapEnergy part;
    part.fixed = fixed;
    force_there.assign(vertex.size(), {});
    const BoundaryBarrier barrier(whole, part, vertex);
    CHECK(barrier.first_contact(uv, std::vector<Vec2>(uv.size(), Vec2{}), 1) == kInfinity);
    return barrier.add_forces(uv, force_there);
  };
  std::vector<Vec2> there;
  CHECK(part_energy(backwards, there) == doctest::Approx(energy).epsilon(1e-14));
  for (Index i = 0; i < n; ++i)
    CHECK(norm(there[i] - force[backwards[i]]) <= 1e-14 * norm(force[backwards[i]]));
  CHECK(part_energy(one_end, there) == 0);
}

TEST_CASE("boundary barrier: the elimination order is found anew where contacts couple many vertices") {
  constexpr Index kSide = 12;
  const GridMap grid(kSide);
  const ArapEnergy mesh = grid.piece.energy(grid.nodes.fixed);
  const BoundaryBarrier barrier(grid.exec, mesh, grid.piece.topology(), grid.piece.component);
  Vec2 low = grid.flat.front(), high = low;
  for (const Vec2 z : grid.flat) {
    low = {std::min(low.x, z.x), std::min(low.y, z.y)};
    high = {std::max(high.x, z.x), std::max(high.y, z.y)};
  }
  const double side = high.x - low.x, close = 0.1 * side / kSide;
  // Rolled up, left and right edge at a distance that grows with the radius.
  const auto orders_found = [&](double opening) {
    std::vector<Vec2> x;
    for (const Vec2 z : grid.flat) {
      const double radius = side * (1 + (high.y - z.y) / side), share = (z.x - low.x) / side;
      const double gap = close / radius + opening * (radius - side) / side;
      x.push_back(radius * unit((2 * kPi - gap) * share));
    }
    NewtonMap map(
        grid.exec, mesh,
        whole_unknowns(*grid.dof, grid.piece.order, grid.piece.component, std::vector<std::uint8_t>{1}, x),
        grid.dof.get(), x);
    map.keep_apart(&barrier);
    map.lower({});
    REQUIRE(barrier.near(x).size() > 0);
    REQUIRE(map.is_positive());
    REQUIRE(map.prepare());
    return map.orders_found();
  };
  CHECK(orders_found(0) == 1);
  CHECK(orders_found(1) == 0);  // the inner ends alone are near one another
}
