// A mesh as the constraint code sees it: ordered, measured, with its loops.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "engine/constraints/compile.hpp"
#include "engine/prepare/connection.hpp"
#include "engine/prepare/geometry.hpp"
#include "engine/solve/start.hpp"
#include "tests/support/shapes.hpp"

namespace planish::tests {

/// Vertices and triangles are named by their numbers in the input; `here` and `triangle_here` give those of the ordered
/// mesh.
class Rest {
 public:
  explicit Rest(const Mesh& input) : prepared(prepare(Exec(1), input.surface()).value()) {
    geometry = measure_geometry(Exec(1), prepared);
    component = vertex_components(topology(), mesh().num_vertices());
    outer = outer_loops(topology());
    loop_of.assign(mesh().num_vertices(), kNone);
    for (Index l = 0; l < topology().num_loops(); ++l) {
      for (const Index c : slice(In<Index>(topology().loop_corner), topology().loops().group(l)))
        loop_of[mesh().corner_vertex[c]] = l;
    }
    here.assign(mesh().num_input_vertices, kNone);
    for (Index v = 0; v < mesh().num_vertices(); ++v) here[mesh().vertex_origin[v]] = v;
    triangle_here.resize(mesh().num_triangles());
    for (Index t = 0; t < mesh().num_triangles(); ++t) triangle_here[mesh().triangle_origin[t]] = t;
    order.resize(mesh().num_vertices());
    std::iota(order.begin(), order.end(), 0);
    surface = {&mesh(), &topology(), geometry.frame, outer, loop_of};
  }
  Rest(const Rest&) = delete;
  Rest& operator=(const Rest&) = delete;

  const OrderedMesh& mesh() const { return prepared.mesh; }
  const Topology& topology() const { return prepared.topology; }
  StartInput start_input() const {
    return {mesh().corner_vertex, &topology(), geometry.frame, geometry.cotangent,
            geometry.angle_sum,   order,       outer};
  }

  Feature chain(const std::string& name, std::vector<Index> vertex, bool closed = false) const {
    for (Index& v : vertex) v = here[v];
    return {.name = name, .vertex = std::move(vertex), .closed = closed};
  }
  /// The triangles whose centres, in the input's coordinates, are inside.
  template <class Inside>
  Feature region(const std::string& name, Inside inside) const {
    Feature feature{.name = name};
    for (Index t = 0; t < mesh().num_triangles(); ++t) {
      Vec3 sum{};
      for (Index c = 3 * t; c < 3 * t + 3; ++c) sum = sum + mesh().position[mesh().corner_vertex[c]];
      if (inside((mesh().unit / 3) * sum + mesh().centre)) feature.triangle.push_back(t);
    }
    return feature;
  }

  PreparedMesh prepared;
  Geometry geometry;
  std::vector<Index> component, outer, loop_of, order;
  std::vector<Index> here, triangle_here;
  RestSurface surface;
};

/// Vertices from (i0, j0) to (i1, j1) of an n x n grid, along a row, a column or a diagonal.
inline std::vector<Index> grid_path(Index n, Index i0, Index j0, Index i1, Index j1) {
  std::vector<Index> path;
  const Index steps = std::max(std::abs(i1 - i0), std::abs(j1 - j0));
  for (Index k = 0; k <= steps; ++k)
    path.push_back((j0 + k * (j1 - j0) / steps) * n + i0 + k * (i1 - i0) / steps);
  return path;
}

/// Around the rectangle [i0, i1] x [j0, j1] of an n x n grid, counter-clockwise.
inline std::vector<Index> grid_loop(Index n, Index i0, Index j0, Index i1, Index j1) {
  std::vector<Index> loop;
  for (const auto& side : {grid_path(n, i0, j0, i1, j0), grid_path(n, i1, j0, i1, j1),
                           grid_path(n, i1, j1, i0, j1), grid_path(n, i0, j1, i0, j0)})
    loop.insert(loop.end(), side.begin(), side.end() - 1);
  return loop;
}

/// Rings of n_a cells over an angle of `sweep` (2 pi: closed), radii from r0 to r1 in n_r steps; vertex j * columns + i is at
/// radius j and angle i. columns: n_a, or n_a + 1 where it is open.
inline Mesh polar_mesh(Index n_r, Index n_a, double r0, double r1, double sweep) {
  const bool closed = sweep >= 2 * kPi;
  const Index columns = closed ? n_a : n_a + 1;
  Mesh mesh;
  for (Index j = 0; j <= n_r; ++j) {
    for (Index i = 0; i < columns; ++i) {
      const Vec2 p = (r0 + (r1 - r0) * j / n_r) * unit(sweep * i / n_a);
      mesh.position.push_back({p.x, p.y, 0});
    }
  }
  for (Index j = 0; j < n_r; ++j) {
    for (Index i = 0; i < n_a; ++i) {
      const Index a = j * columns + i, b = j * columns + (i + 1) % columns, c = a + columns, d = b + columns;
      mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, c, d, a, d, b});
    }
  }
  return mesh;
}

/// An n x n grid of a flat sheet, vertices shifted along its rulings, and the same sheet bent by `bend` radians at each
/// ruling: isometric to rounding.
struct BentSheet {
  std::vector<Vec2> flat;
  Mesh mesh;
};
inline BentSheet bent_sheet(Index n, double bend) {
  BentSheet sheet;
  sheet.mesh = shapes::height_field(n, shapes::flat, 0);
  shapes::Random random(3);
  const double step = 2.0 / (n - 1);
  std::vector<Vec2> profile = {{0, 0}};  // x, z
  for (Index i = 1; i < n; ++i) profile.push_back(profile.back() + step * unit(-bend * i));
  for (Index v = 0; v < n * n; ++v) {
    const double along = step * (v / n + 0.3 * (random.uniform() - 0.5));
    sheet.flat.push_back({step * (v % n), along});
    sheet.mesh.position[v] = {profile[v % n].x, along, profile[v % n].y};
  }
  return sheet;
}

/// A map for regions that must unroll.
inline Result<std::vector<Vec2>> no_map(const Surface&) {
  return fail(ErrorCode::InternalDefect, "no map was expected");
}

inline Constraint named(const std::string& name, decltype(Constraint::rule) rule) {
  return {.name = name, .type = {}, .rule = std::move(rule)};
}

inline double largest_distance(In<Vec2> a, In<Vec2> b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, norm(a[i] - b[i]));
  return largest;
}

}  // namespace planish::tests
