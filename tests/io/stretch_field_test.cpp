#include "io/stretch_field.hpp"

#include <doctest/doctest.h>

#include "io/raster.hpp"

namespace planish {
namespace {

using doctest::Approx;

/// n unit right triangles side by side in space; their images are scaled by scale[t] along u.
struct Row {
  std::vector<Vec3> position;
  std::vector<Index> corner_vertex;
  std::vector<Vec2> uv;
  Surface surface() const { return {position, corner_vertex}; }
};

Row row_of(const std::vector<double>& scale) {
  Row row;
  for (std::size_t t = 0; t < scale.size(); ++t) {
    const double x = 2 * static_cast<double>(t);
    for (const Vec3 p : {Vec3{x, 0, 0}, Vec3{x + 1, 0, 0}, Vec3{x, 1, 0}}) {
      row.corner_vertex.push_back(static_cast<Index>(row.position.size()));
      row.position.push_back(p);
      row.uv.push_back({scale[t] * (p.x - x), p.y});
    }
  }
  return row;
}

TEST_CASE("stretch_field: the singular value with the larger logarithm decides") {
  CHECK(stretch_deviation({1.25, 0.9}) == Approx(0.25));
  CHECK(stretch_deviation({1.25, 0.75}) == Approx(-0.25));  // 1 / 0.75 > 1.25
  CHECK(stretch_deviation({1.2, 1.1}) == Approx(0.2));
  CHECK(stretch_deviation({0.9, 0.8}) == Approx(-0.2));
  CHECK(stretch_deviation({1, 1}) == 0);
  CHECK(stretch_deviation({5, -0.5}) == -1);
  CHECK(stretch_deviation({kInfinity, kInfinity}) == kInfinity);
}

TEST_CASE("stretch_field: the limit is the nice number that holds 99% of the area") {
  std::vector<double> scale(200, 1.035);
  scale[0] = 3;  // 0.5% of the area: beyond the limit, cut off
  const Row row = row_of(scale);
  const StretchField field = stretch_field(Exec(), row.surface(), row.uv, {});
  CHECK(field.limit == 0.04);
  CHECK(field.value[1] == Approx(0.035 / 0.04));
  CHECK(field.value[0] == 1);
}

TEST_CASE("stretch_field: flipped triangles carry their mark and do not widen the limit") {
  const Row row = row_of({1, 1, -1});
  const std::vector<Index> flipped{2};
  const StretchField field = stretch_field(Exec(), row.surface(), row.uv, flipped);
  CHECK(field.value[2] == kFlippedValue);
  CHECK(field.value[0] == Approx(0));
  CHECK(field.limit == 1e-4);
}

TEST_CASE("stretch_field: a triangle without area at rest is the end of the scale and weighs nothing") {
  Row row = row_of({1.015, 1.015});
  row.position[5] = row.position[4];
  const StretchField field = stretch_field(Exec(), row.surface(), row.uv, {});
  CHECK(field.value[1] == 1);
  CHECK(field.limit == Approx(0.02));
}

}  // namespace
}  // namespace planish
