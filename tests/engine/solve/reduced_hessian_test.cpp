#include "engine/solve/reduced_hessian.hpp"

#include <doctest/doctest.h>

#include "engine/solve/determinant_multiples.hpp"
#include "tests/support/grid_map.hpp"

using namespace planish;

namespace {

using Dense = std::vector<std::vector<double>>;

Dense dense(const SymmetricMatrix& matrix) {
  Dense full(matrix.size(), std::vector<double>(matrix.size(), 0.0));
  for (Index column = 0; column < matrix.size(); ++column) {
    for (Index k = matrix.column_begin[column]; k < matrix.column_begin[column + 1]; ++k)
      full[matrix.row[k]][column] = full[column][matrix.row[k]] = matrix.value[k];
  }
  return full;
}

std::vector<Vec2> disturbed(const GridMap& grid, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> change(-0.02, 0.02);
  std::vector<Vec2> x = grid.flat;
  for (Vec2& z : x) z += Vec2{change(random), change(random)};
  return x;
}

double& coordinate(std::vector<Vec2>& x, const ReducedUnknowns& unknowns, Index k) {
  Vec2& z = x[unknowns.vertex[k / 2]];
  return k % 2 == 0 ? z.x : z.y;
}

/// The last vertices of `free` carried instead by two translations and what turns and shears them.
ReducedUnknowns carried(const ReducedUnknowns& free, Index num_carried) {
  ReducedUnknowns unknowns = free;
  const Index first = 2 * (free.num_pairs() - num_carried);
  unknowns.vertex.resize(free.vertex.size() - num_carried);
  unknowns.feature_place.assign(free.pair.size(), kNone);
  unknowns.move_begin = {0};
  for (Index i = 0; i < num_carried; ++i) {
    const Index v = free.vertex[unknowns.vertex.size() + i];
    unknowns.pair[v] = kNone;
    unknowns.feature_place[v] = i;
    unknowns.feature_vertex.push_back(v);
    unknowns.move.insert(unknowns.move.end(), {{first, {1, 0}}, {first + 1, {0, 1}}});
    if (i > 0) unknowns.move.push_back({first + 2, {0.1 * i, -0.3}});
    unknowns.move_begin.push_back(static_cast<Index>(unknowns.move.size()));
  }
  unknowns.size = first + 3;
  return unknowns;
}

const MapDensity kDensities[] = {{.kind = MapDensity::Kind::Arap},
                                 {.kind = MapDensity::Kind::SymmetricDirichlet},
                                 {.kind = MapDensity::Kind::Untangling, .epsilon = 0.1}};

}  // namespace

TEST_CASE("reduced hessian: at one place after another it is the central difference of forces") {
  const GridMap grid(4);
  const ArapEnergy mesh = grid.energy();
  const ReducedUnknowns unknowns = grid.inner();
  MapEnergy energy(grid.exec, mesh);
  ReducedHessian hessian;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::vector<Vec2> x = disturbed(grid, seed), before(x.size()), after(x.size());
    const MapDensity& density = kDensities[seed - 1];
    const Dense matrix = dense(hessian.at(grid.exec, mesh, unknowns, density, 0, x));
    for (Index column = 0; column < unknowns.size; ++column) {
      constexpr double kStep = 1e-6;
      double& moved = coordinate(x, unknowns, column);
      const double place = moved;
      moved = place - kStep;
      energy.evaluate(density, x, before);
      moved = place + kStep;
      energy.evaluate(density, x, after);
      moved = place;
      for (Index row = 0; row < unknowns.size; ++row) {
        const double slope =
            (coordinate(after, unknowns, row) - coordinate(before, unknowns, row)) / (2 * kStep);
        CHECK(std::abs(matrix[row][column] - slope) < 1e-5 * (1 + std::abs(slope)));
      }
    }
  }
}

TEST_CASE("reduced hessian: over moves of features it is that over their vertices, between the moves") {
  const GridMap grid(6);
  const ArapEnergy mesh = grid.energy();
  const ReducedUnknowns free = grid.inner(), unknowns = carried(free, 4);
  Dense move(free.size, std::vector<double>(unknowns.size, 0.0));
  for (Index k = 0; k < free.num_pairs(); ++k) {
    const Index v = free.vertex[k], pair = unknowns.pair[v];
    if (pair != kNone) move[2 * k][2 * pair] = move[2 * k + 1][2 * pair + 1] = 1;
    for (const auto& [unknown, by] : unknowns.moves_of(v)) {
      move[2 * k][unknown] = by.x;
      move[2 * k + 1][unknown] = by.y;
    }
  }
  const std::vector<HessianElement> further = {
      {{free.vertex[0], free.vertex[0], free.vertex[0]}, {{{{{2, 0, 0, 3}}}}}},
      {{free.vertex[1], free.vertex.back(), free.vertex[3]},
       {{{{{1, 0.5, 0.5, 2}, {0.1, 0.2, 0.3, 0.4}, {}}},
         {{{0.1, 0.3, 0.2, 0.4}, {3, 0.25, 0.25, 1}, {}}},
         {{{}, {}, {}}}}}}};
  ReducedHessian over_vertices, over_moves;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::vector<Vec2> x = disturbed(grid, seed);
    const MapDensity& density = kDensities[seed - 1];
    const Dense full = dense(over_vertices.at(grid.exec, mesh, free, density, 0.5, x, further));
    const Dense reduced = dense(over_moves.at(grid.exec, mesh, unknowns, density, 0.5, x, further));
    for (Index row = 0; row < unknowns.size; ++row) {
      for (Index column = 0; column < unknowns.size; ++column) {
        double expected = 0;
        for (Index i = 0; i < free.size; ++i) {
          for (Index j = 0; j < free.size; ++j) expected += move[i][row] * full[i][j] * move[j][column];
        }
        CHECK(std::abs(reduced[row][column] - expected) < 1e-9 * (1 + std::abs(expected)));
      }
    }
  }
}

TEST_CASE(
    "reduced hessian: projected with multiples of det J it is the true one of what is compressed to 0.7") {
  const GridMap grid(8);
  const ArapEnergy mesh = grid.energy();
  const std::vector<double> multiple = determinant_multiples(mesh);
  std::vector<Vec2> x = disturbed(grid, 3);
  for (Vec2& z : x) z = 0.7 * z;
  ReducedHessian one, other;
  const MapDensity no_wall{.kind = MapDensity::Kind::Arap, .barrier = {.weight = 0, .delta = 1e-12}};
  const auto at = [&](ReducedHessian& hessian, double projection, In<double> by) {
    return hessian.at(grid.exec, mesh, grid.inner(), no_wall, projection, x, {}, by);
  };
  const SymmetricMatrix exact = at(one, 0, multiple), projected = at(other, 1, multiple);
  double difference = 0;
  for (std::size_t k = 0; k < exact.value.size(); ++k)
    difference = std::max(difference, std::abs(exact.value[k] - projected.value[k]));
  CHECK(difference < 1e-12);
  CHECK(at(one, 1, {}).value != projected.value);
}

TEST_CASE("determinant multiples: they fall to 0 at boundaries that are free, and nowhere else") {
  const GridMap grid(24);
  const std::vector<std::uint8_t> none(grid.rim.size(), 0);
  const ArapEnergy held = grid.energy(), free = grid.piece.energy(none);
  for (const double m : determinant_multiples(held)) CHECK(m == 2);
  const std::vector<double> multiple = determinant_multiples(free);
  Vec2 first = grid.flat.front(), last = first;
  for (const Vec2 z : grid.flat) {
    first = {std::min(first.x, z.x), std::min(first.y, z.y)};
    last = {std::max(last.x, z.x), std::max(last.y, z.y)};
  }
  for (Index t = 0; t < free.num_triangles(); ++t) {
    double nearest = kInfinity;  // rows and columns from the rim
    for (Index c = 3 * t; c < 3 * t + 3; ++c) {
      const Vec2 z = grid.flat[free.corner_vertex[c]];
      for (const double d : {z.x - first.x, last.x - z.x, z.y - first.y, last.y - z.y})
        nearest = std::min(nearest, 24 * d / (last.x - first.x));
    }
    CHECK(multiple[t] == doctest::Approx(std::min(2.0, nearest / 4)).epsilon(1e-9));
  }
}

TEST_CASE("reduced hessian: held unknowns are unit rows, and one thread or many give the same bits") {
  const GridMap grid(40);
  const ArapEnergy mesh = grid.energy();
  ReducedUnknowns unknowns = carried(grid.inner(), 5);
  unknowns.held = {7};
  const std::vector<Vec2> x = disturbed(grid, 5);
  ReducedHessian one, many;
  const SymmetricMatrix& matrix = one.at(Exec(1), mesh, unknowns, kDensities[0], 1, x);
  for (Index column = 0; column < matrix.size(); ++column) {
    for (Index k = matrix.column_begin[column]; k < matrix.column_begin[column + 1]; ++k) {
      if (column == 7 || matrix.row[k] == 7) CHECK(matrix.value[k] == (column == matrix.row[k] ? 1 : 0));
    }
  }
  CHECK(many.at(Exec(7), mesh, unknowns, kDensities[0], 1, x).value == matrix.value);
}

TEST_CASE("reduced hessian: curvature of the ways of features counts as far as it is not projected") {
  const GridMap grid(6);
  const ArapEnergy mesh = grid.energy();
  const ReducedUnknowns straight = carried(grid.inner(), 4);
  ReducedUnknowns curved = straight;
  const Index last = straight.size - 1;
  curved.curvature = {{last, last, -3}, {last, last - 2, 7}};
  const std::vector<Vec2> x = disturbed(grid, 2);
  for (const double projection : {0.0, 0.25, 1.0}) {
    ReducedHessian one, other;
    Dense expected = dense(one.at(grid.exec, mesh, straight, kDensities[0], projection, x));
    const Dense found = dense(other.at(grid.exec, mesh, curved, kDensities[0], projection, x));
    expected[last][last] += (1 - projection) * -3;
    expected[last][last - 2] += (1 - projection) * 7;
    expected[last - 2][last] += (1 - projection) * 7;
    for (Index row = 0; row < straight.size; ++row) {
      for (Index column = 0; column < straight.size; ++column)
        CHECK(found[row][column] == doctest::Approx(expected[row][column]).epsilon(1e-12));
    }
  }
}
