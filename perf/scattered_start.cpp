// Flat squares whose rims are held and whose inner vertices begin anywhere: who lays them out without flips.
//   scattered_start SIDE SEEDS: a line a method, "METHOD SOLVED SEEDS SECONDS"
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <random>

#include "engine/solve/flip_free.hpp"
#include "engine/solve/weighted_steps.hpp"
#include "engine/workpiece.hpp"
#include "kernels/local/proxy.hpp"

using namespace planish;

namespace {

Mesh square(Index side) {
  Mesh mesh;
  const Index row = side + 1;
  for (Index j = 0; j <= side; ++j) {
    for (Index i = 0; i <= side; ++i) mesh.position.push_back({double(i) / side, double(j) / side, 0});
  }
  for (Index j = 0; j < side; ++j) {
    for (Index i = 0; i < side; ++i) {
      const Index a = j * row + i, d = a + row;
      for (const Index v : {a, a + 1, d + 1, a, d + 1, d}) mesh.corner_vertex.push_back(v);
    }
  }
  return mesh;
}

/// The square's rim held where it lies.
struct Held {
  Exec exec{0};
  Mesh mesh;
  Workpiece piece;
  NodeMap nodes;
  std::vector<Vec2> flat;

  explicit Held(Index side) : mesh(square(side)), piece(*make_workpiece(exec, mesh.surface())) {
    const Index n = piece.mesh().num_vertices();
    nodes.num_nodes = n;
    nodes.fixed.resize(n);
    for (Index v = 0; v < n; ++v) {
      nodes.fixed[v] = piece.topology().is_boundary(v);
      nodes.node.push_back(nodes.fixed[v] ? kNone : v);
      const Vec3 p = piece.mesh().position[v];
      flat.push_back({p.x, p.y});
      if (nodes.fixed[v]) nodes.place.emplace_back(v, flat.back());
    }
    piece.order = *fill_reducing_order(exec, piece.laplacian_over(exec, nodes));
  }

  std::vector<Vec2> scattered(unsigned seed) const {
    const double extent = norm(flat.back() - flat.front());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-0.5 * extent, 0.5 * extent);
    std::vector<Vec2> uv = flat;
    for (std::size_t v = 0; v < uv.size(); ++v) {
      if (!nodes.fixed[v]) uv[v] = {place(random), place(random)};
    }
    return uv;
  }

  /// Of the triangles of a map.
  std::vector<Vec2> rotations(In<Vec2> uv) const {
    const ArapEnergy energy = piece.energy(nodes.fixed);
    std::vector<Vec2> rotation;
    for (Index t = 0; t < energy.num_triangles(); ++t) {
      rotation.push_back(closest_rotation(corner_images(energy.corner_vertex, t, uv),
                                          &energy.cotangent[3 * t], energy.frame[t]));
    }
    return rotation;
  }

  /// Whether no triangle is flipped in the end.
  bool solves(Flips flips, unsigned seed) const {
    const std::vector<Vec2> start = scattered(seed), rotation = rotations(start);
    DofMap dof(nodes);
    auto global = *piece.factor(exec, piece.laplacian_over(exec, nodes));
    ArapProblem problem = piece.problem(global, nodes, dof, dof, rotation);
    problem.turns_freely = {0};
    FlattenOptions options;
    options.flips = flips;
    MapEnergy measure(exec, problem.energy);
    if (flips != Flips::Untangle) {
      const auto weighted = weighted_global_steps(exec, problem, {}, options, {});
      return weighted && measure.is_injective(weighted->uv);
    }
    Minimum minimum;
    minimum.uv = start;
    minimum.history.push_back({});
    return remove_flips(exec, problem, options, {}, minimum) && measure.is_injective(minimum.uv);
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: scattered_start SIDE SEEDS\n");
    return 2;
  }
  const Held held(std::atoi(argv[1]));
  const int seeds = std::atoi(argv[2]);
  for (const Flips flips : {Flips::Untangle, Flips::Weights, Flips::Stiffening}) {
    const auto begin = std::chrono::steady_clock::now();
    int solved = 0;
    for (int seed = 1; seed <= seeds; ++seed) solved += held.solves(flips, seed);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    fmt::print("{} {} {} {:.2f}\n", name(flips), solved, seeds, seconds);
  }
}
