// Newton directions on the ARAP energy.
#include "engine/solve/newton.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "engine/workpiece.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// A bumpy square, its plan with a little noise as the map, and some vertices held.
struct Held {
  Exec exec{2};
  Mesh mesh = shapes::height_field(
      20, [](double x, double y) { return 0.2 * x * y; }, 0.02);
  Workpiece piece;
  std::vector<std::uint8_t> fixed;
  std::vector<Vec2> uv;

  explicit Held(const std::vector<Index>& held) {
    piece = *make_workpiece(exec, mesh.surface());
    piece.order = *fill_reducing_order(exec, piece.whole_laplacian(exec));
    fixed.assign(piece.mesh().num_vertices(), 0);
    for (const Index v : held) fixed[v] = 1;
    for (const Vec3 p : piece.mesh().position)
      uv.push_back({p.x + 1e-3 * std::sin(40 * p.y), p.y + 1e-3 * std::cos(50 * p.x)});
  }
  ArapEnergy energy() const { return piece.energy(fixed); }
  std::vector<Vec2> force_at(const std::vector<Vec2>& z) const {
    std::vector<Vec2> force(z.size());
    LocalPhase(exec, energy()).evaluate(z, force);
    return force;
  }
  std::vector<Vec2> direction() const {
    std::vector<Vec2> d(uv.size());
    NewtonDirections newton(exec, energy(), piece.order, piece.component, 1);
    REQUIRE(newton.direction(uv, force_at(uv), d).has_value());
    return d;
  }
  std::vector<Vec2> moved(const std::vector<Vec2>& d, double by) const {
    std::vector<Vec2> z = uv;
    for (std::size_t v = 0; v < z.size(); ++v) z[v] += by * d[v];
    return z;
  }
};

double largest(const std::vector<Vec2>& a) {
  double most = 0;
  for (const Vec2 z : a) most = std::max(most, norm(z));
  return most;
}

}  // namespace

TEST_CASE("newton: with several vertices held the forces fall along the direction by what they are") {
  for (const std::vector<Index>& pins : {std::vector<Index>{0, 57}, {3, 11, 120, 250, 399}}) {
    const Held scene(pins);
    const std::vector<Vec2> d = scene.direction(), force = scene.force_at(scene.uv);
    constexpr double kStep = 1e-4;
    const std::vector<Vec2> after = scene.force_at(scene.moved(d, kStep)),
                            before = scene.force_at(scene.moved(d, -kStep));
    std::vector<Vec2> left = force;
    for (std::size_t v = 0; v < left.size(); ++v) left[v] += (0.5 / kStep) * (after[v] - before[v]);
    CHECK(largest(left) < 1e-6 * largest(force));
    for (const Index v : pins) CHECK(d[v] == Vec2{});
  }
}

TEST_CASE("newton: with one vertex held a far one keeps a coordinate, no more") {
  const Held scene({0});
  const std::vector<Vec2> d = scene.direction();
  Index kept = 0;
  for (std::size_t v = 0; v < d.size(); ++v) {
    if (scene.fixed[v]) continue;
    kept += (d[v].x == 0) + (d[v].y == 0);
  }
  CHECK(d[0] == Vec2{});
  CHECK(kept == 1);
}
