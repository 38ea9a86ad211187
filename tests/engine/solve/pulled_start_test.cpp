#include "engine/solve/pulled_start.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "engine/workpiece.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;

namespace {

/// A flat square of 10 x 10 cells, nothing held.
struct Sheet {
  Exec exec{2};
  Mesh mesh = shapes::height_field(11, shapes::flat, 0);
  Workpiece piece;
  NodeMap nodes;
  std::unique_ptr<DofMap> dof;
  std::vector<Vec2> flat;
  double cell = 0;

  Sheet() {
    piece = *make_workpiece(exec, mesh.surface());
    const Index n = piece.mesh().num_vertices();
    nodes.node.resize(n);
    std::iota(nodes.node.begin(), nodes.node.end(), 0);
    nodes.fixed.assign(n, 0);
    nodes.num_nodes = n;
    dof = std::make_unique<DofMap>(nodes);
    piece.order = *fill_reducing_order(exec, piece.whole_laplacian(exec));
    for (const Vec3 p : piece.mesh().position) flat.push_back({p.x, p.y});
    cell = std::sqrt(piece.geometry.area) / 10;
  }
  ArapProblem problem() const {
    return {.energy = piece.energy(nodes.fixed),
            .topology = &piece.topology(),
            .edge_weight = {},
            .dof = dof.get(),
            .rotation = {},
            .order = piece.order,
            .vertex_component = piece.component,
            .turns_freely = {0}};
  }
  /// The vertex nearest to a place, in cells from the middle.
  Index at(double x, double y) const {
    Index nearest = 0;
    for (Index v = 0; v < static_cast<Index>(flat.size()); ++v) {
      if (norm(flat[v] - cell * Vec2{x, y}) < norm(flat[nearest] - cell * Vec2{x, y})) nearest = v;
    }
    return nearest;
  }
  Result<std::optional<std::vector<Vec2>>> pull(const std::vector<VertexPlace>& places) const {
    int steps = 0;
    const auto stay = [&](std::vector<Vec2> uv) { return PulledMap{std::move(uv), places}; };
    return pull_into_place(exec, problem(), {}, stay, {}, flat, steps);
  }
};

}  // namespace

TEST_CASE(
    "pulled start: vertices come to their places though they would flip triangles if they were put there") {
  const Sheet sheet;
  std::vector<VertexPlace> places;
  for (const double x : {-5.0, 0.0, 5.0}) places.emplace_back(sheet.at(x, -5), sheet.flat[sheet.at(x, -5)]);
  for (const double x : {-2.0, 2.0}) {
    const Index v = sheet.at(x, 0);
    places.emplace_back(v, sheet.flat[v] + sheet.cell * Vec2{0, 2.5});
  }
  MapEnergy measure(sheet.exec, sheet.piece.energy(sheet.nodes.fixed));
  std::vector<Vec2> put = sheet.flat;
  for (const auto& [v, place] : places) put[v] = place;
  REQUIRE_FALSE(measure.flipped(put).empty());
  const auto pulled = sheet.pull(places);
  REQUIRE(pulled.has_value());
  REQUIRE(pulled->has_value());
  CHECK(measure.is_injective(**pulled));
  for (const auto& [v, place] : places) CHECK((**pulled)[v] == place);
}

TEST_CASE("pulled start: there is none where the places themselves turn a triangle over") {
  const Sheet sheet;
  const Index* v = sheet.piece.mesh().corner_vertex.data();
  const auto pulled =
      sheet.pull({{v[0], sheet.flat[v[1]]}, {v[1], sheet.flat[v[0]]}, {v[2], sheet.flat[v[2]]}});
  REQUIRE(pulled.has_value());
  CHECK_FALSE(pulled->has_value());
}
