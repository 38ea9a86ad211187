#include "engine/verify/benchmark.hpp"

#include <doctest/doctest.h>

#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

BenchmarkFigures figures_of(const Mesh& mesh, const std::vector<Vec2>& uv, int threads = 2) {
  const Exec exec(threads);
  std::vector<RestFrame> frame(mesh.num_triangles());
  rest_frames({0, mesh.num_triangles()}, mesh.position, mesh.corner_vertex, frame);
  const Overlaps overlaps = find_overlaps(exec, mesh.corner_vertex, uv, rest_areas(exec, frame));
  return benchmark_figures(exec, mesh.corner_vertex, build_topology(exec, mesh.surface()), frame, uv,
                           overlaps);
}

template <class Map>
std::vector<Vec2> mapped(const Mesh& mesh, Map map) {
  std::vector<Vec2> uv;
  for (const Vec3 p : mesh.position) uv.push_back(map(p));
  return uv;
}

}  // namespace

TEST_CASE(
    "benchmark: a similarity has no distortion, singular values of 1, and the resolution of its extent") {
  const Mesh mesh = shapes::height_field(9, shapes::flat);
  const auto f = figures_of(mesh, mapped(mesh, [](Vec3 p) { return Vec2{-3 * p.y, 3 * p.x}; }));
  CHECK(f.max_area_distortion == Approx(0).scale(1));
  CHECK(f.average_area_error == Approx(0).scale(1));
  CHECK(f.min_singular_value == Approx(1));
  CHECK(f.max_singular_value == Approx(1));
  CHECK(f.proportion_flipped_triangles == 0);
  CHECK(f.bijectivity_violation_area == 0);
  CHECK(f.max_angle_distortion == Approx(0).scale(1));
  CHECK(f.average_angle_error < 1e-12);
  CHECK(f.resolution == Approx(2));  // the square is 2 wide: scaled into the unit square lengths halve
}

TEST_CASE("benchmark: a stretch by 2 along one axis has singular values of sqrt 2 and 1 / sqrt 2 at area 1") {
  const Mesh mesh = shapes::height_field(9, shapes::flat);
  const auto f = figures_of(mesh, mapped(mesh, [](Vec3 p) { return Vec2{2 * p.x, p.y}; }));
  CHECK(f.max_area_distortion == Approx(0).scale(1));
  CHECK(f.max_singular_value == Approx(std::sqrt(2.0)));
  CHECK(f.min_singular_value == Approx(std::sqrt(0.5)));
  CHECK(f.max_angle_distortion == Approx(0.5));  // 2 + 1/2 - 2
  CHECK(f.resolution == Approx(4));              // 4 wide, and not stretched across
}

TEST_CASE("benchmark: area errors of two triangles, one twice as large in the map") {
  // Rest: two halves of the unit square. Map: legs 1 and 1, legs 2 and 1: areas 1/2 and 1.
  Mesh mesh;
  mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.corner_vertex = {0, 1, 2, 0, 2, 3};
  const auto f = figures_of(mesh, {{0, 0}, {1, 0}, {1, 1}, {-1, 1}});
  CHECK(f.average_area_error == Approx(1.0 / 6 + 1.0 / 6));
  CHECK(f.max_area_distortion == Approx(2.0 / 3 + 1.5 - 2));
  // The second triangle's angles: 45, 45, 90 become 90, 45, 45.
  CHECK(f.average_angle_error == Approx(0.5 * (kPi / 4 + kPi / 4)));
}

TEST_CASE(
    "benchmark: a sheet folded in half covers all of its area once, and one half of it is turned over") {
  const Mesh mesh = shapes::height_field(9, shapes::flat, 0);
  const auto f = figures_of(mesh, mapped(mesh, [](Vec3 p) { return Vec2{std::abs(p.x), p.y}; }));
  CHECK(f.proportion_flipped_triangles == Approx(0.5));
  CHECK(f.bijectivity_violation_area == Approx(1));
}

TEST_CASE(
    "benchmark: a boundary fan that winds over itself is seen, though its triangles share their vertex") {
  Mesh fan;
  std::vector<Vec2> uv;
  fan.position.push_back({0, 0, 0});
  uv.push_back({0, 0});
  constexpr int kSteps = 8;  // of 60 degrees: 480 in the map, 120 of them twice
  for (int k = 0; k <= kSteps; ++k) {
    fan.position.push_back({std::cos(k * kPi / 6), std::sin(k * kPi / 6), 0.5 * k});
    uv.push_back(unit(k * kPi / 3));
    if (k > 0) fan.corner_vertex.insert(fan.corner_vertex.end(), {0, k, k + 1});
  }
  std::vector<double> area;
  double total = 0;
  for (int t = 0; t < kSteps; ++t) {
    area.push_back(0.5 * norm(cross(fan.position[t + 1], fan.position[t + 2])));
    total += area.back();
  }
  const auto f = figures_of(fan, uv);
  CHECK(f.proportion_flipped_triangles == 0);
  CHECK(f.bijectivity_violation_area == Approx((area[0] + area[1] + area[6] + area[7]) / total));
}

TEST_CASE("benchmark: figures do not change with a rigid motion, a scale, other labels, or threads") {
  const Mesh mesh = shapes::wavy_disk(800);
  const auto drop = [](Vec3 p) { return Vec2{p.x + 0.2 * p.z, p.y}; };
  const std::vector<Vec2> uv = mapped(mesh, drop);
  const auto f = figures_of(mesh, uv, 1);
  const auto moved = figures_of(shapes::scaled(shapes::rigid_motion(mesh, 3), 7), uv, 7);
  CHECK(moved.average_area_error == Approx(f.average_area_error));
  CHECK(moved.average_angle_error == Approx(f.average_angle_error));
  CHECK(moved.max_angle_distortion == Approx(f.max_angle_distortion));
  CHECK(moved.max_singular_value == Approx(f.max_singular_value));
  CHECK(moved.resolution == Approx(7 * f.resolution));
  std::vector<Index> new_of_old;
  const Mesh other = shapes::relabelled(mesh, 5, new_of_old);
  std::vector<Vec2> other_uv(uv.size());
  for (std::size_t v = 0; v < uv.size(); ++v) other_uv[new_of_old[v]] = uv[v];
  CHECK(figures_of(other, other_uv).average_angle_error == Approx(f.average_angle_error));
  CHECK(figures_of(mesh, uv, 7).average_angle_error == f.average_angle_error);
}
