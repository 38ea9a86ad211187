// A grid, or another mesh in the plane, with what its maps are measured and moved by.
#pragma once

#include <memory>
#include <random>

#include "engine/solve/newton_map.hpp"
#include "engine/workpiece.hpp"
#include "tests/support/shapes.hpp"

namespace planish {

/// A flat fan of twelve triangles around vertex 0.
inline Mesh flat_fan() {
  constexpr Index kSpokes = 12;
  Mesh fan;
  fan.position.push_back({0, 0, 0});
  for (Index k = 0; k < kSpokes; ++k) {
    const Vec2 z = unit(2 * kPi * k / kSpokes);
    fan.position.push_back({z.x, z.y, 0});
    fan.corner_vertex.insert(fan.corner_vertex.end(), {0, k + 1, (k + 1) % kSpokes + 1});
  }
  return fan;
}

/// A grid in the plane, its interior moved as told.
struct GridMap {
  Exec exec{1};
  Mesh mesh;
  Workpiece piece;
  NodeMap nodes;
  std::unique_ptr<DofMap> dof;
  std::vector<std::uint8_t> rim;
  std::vector<Vec2> flat;  // without distortion

  explicit GridMap(Index side) : GridMap(shapes::height_field(side + 1, shapes::flat, 0)) {}
  explicit GridMap(Mesh given) : mesh(std::move(given)) {
    piece = *make_workpiece(exec, mesh.surface());
    piece.outer_loop = {0};
    piece.find_loops();
    nodes = find_nodes(piece.component, 1);
    dof = std::make_unique<DofMap>(nodes);
    piece.order = *fill_reducing_order(Exec(2), piece.laplacian_over(exec, nodes));
    for (Index v = 0; v < piece.mesh().num_vertices(); ++v) {
      rim.push_back(piece.topology().is_boundary(v));
      const Vec3 p = piece.mesh().position[v];
      flat.push_back({p.x, p.y});
    }
  }

  /// The rim held.
  ArapEnergy energy() const { return piece.energy(rim); }
  ReducedUnknowns inner() const {
    ReducedUnknowns unknowns;
    unknowns.pair.assign(rim.size(), kNone);
    for (const Index v : piece.order) {
      if (rim[v]) continue;
      unknowns.pair[v] = unknowns.num_pairs();
      unknowns.vertex.push_back(v);
    }
    unknowns.size = 2 * unknowns.num_pairs();
    return unknowns;
  }
  std::vector<Vec2> scattered(unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-0.5, 0.5);
    std::vector<Vec2> x = flat;
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (!rim[v]) x[v] = {place(random), place(random)};
    }
    return x;
  }
};

}  // namespace planish
