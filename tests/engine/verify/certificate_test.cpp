#include "engine/verify/certificate.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "kernels/local/distortion.hpp"
#include "kernels/local/jacobians.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

Certificate certificate_of(const Mesh& mesh, const std::vector<Vec2>& uv) {
  const Topology topology = build_topology(Exec(2), mesh.surface());
  std::vector<RestFrame> frame(mesh.num_triangles());
  rest_frames({0, mesh.num_triangles()}, mesh.position, mesh.corner_vertex, frame);
  return certify(Exec(2), mesh.surface(), topology, frame, uv);
}

std::vector<Vec2> mapped(const Mesh& mesh, const Mat2& m) {
  std::vector<Vec2> uv;
  for (const Vec3 p : mesh.position) uv.push_back({m.m00 * p.x + m.m01 * p.y, m.m10 * p.x + m.m11 * p.y});
  return uv;
}

/// A fan of n triangles around vertex 0, flat, with corner angle 2 pi turns / n in the map.
Mesh fan(Index n, double turns, std::vector<Vec2>& uv) {
  Mesh mesh;
  mesh.position.push_back({0, 0, 0});
  uv.assign(1, {0, 0});
  for (Index i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    mesh.position.push_back({std::cos(a), std::sin(a), 0});
    uv.push_back(unit(turns * a));
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {0, 1 + i, 1 + (i + 1) % n});
  }
  return mesh;
}

}  // namespace

TEST_CASE("certificate: a linear map has the singular values of its matrix everywhere") {
  const Mesh mesh = shapes::height_field(12, shapes::flat);
  const Certificate c = certificate_of(mesh, mapped(mesh, {3, 0, 0, 0.5}));
  CHECK(c.sigma_max.min == Approx(3));
  CHECK(c.sigma_max.max == Approx(3));
  CHECK(c.sigma_min.mean == Approx(0.5));
  CHECK(c.area_ratio.p50 == Approx(1.5));
  CHECK(c.angle_distortion.p99 == Approx(6));
  CHECK(c.arap == Approx(4 + 0.25));
  CHECK(c.symmetric_dirichlet == Approx(9 + 0.25 + 1.0 / 9 + 4));
  CHECK(c.flipped_triangles == 0);
}

TEST_CASE("certificate: a mirror image flips every triangle") {
  const Mesh mesh = shapes::height_field(6, shapes::flat);
  const Certificate c = certificate_of(mesh, mapped(mesh, {1, 0, 0, -1}));
  CHECK(c.flipped_triangles == mesh.num_triangles());
  CHECK(c.arap == Approx(4));
  CHECK(c.sigma_min.max == Approx(-1));
  CHECK(c.symmetric_dirichlet == kInfinity);
}

TEST_CASE("certificate: a triangle collapsed to a segment counts as flipped") {
  const Mesh mesh = shapes::height_field(6, shapes::flat);
  auto uv = mapped(mesh, {1, 0, 0, 1});
  const Index* v = &mesh.corner_vertex[3 * 20];
  uv[v[2]] = 0.5 * (uv[v[0]] + uv[v[1]]);
  const Certificate c = certificate_of(mesh, uv);
  CHECK(std::find(c.flipped.begin(), c.flipped.end(), 20) != c.flipped.end());
  CHECK(c.symmetric_dirichlet == kInfinity);
}

TEST_CASE("certificate: a fan that covers twice is overwound though every triangle is positive") {
  std::vector<Vec2> uv;
  const Mesh once = fan(10, 1, uv);
  CHECK(certificate_of(once, uv).overwound_vertices == 0);
  const Mesh twice = fan(10, 2, uv);
  const Certificate c = certificate_of(twice, uv);
  CHECK(c.overwound == std::vector<Index>{0});
  CHECK(c.flipped_triangles == 0);
}

TEST_CASE("certificate: means and percentiles are weighted by area") {
  // Two squares, one stretched: 1/5 of the area has sigma_max 2.
  const Mesh small = shapes::height_field(2, shapes::flat);  // [-1, 1]^2
  const Mesh mesh = shapes::joined(small, shapes::scaled(small, 2));
  auto uv = mapped(mesh, {1, 0, 0, 1});
  for (Index v = 0; v < 4; ++v) uv[v].x *= 2;
  const Certificate c = certificate_of(mesh, uv);
  CHECK(c.sigma_max.mean == Approx(1.2));
  CHECK(c.sigma_max.p50 == Approx(1));
  CHECK(c.sigma_max.p99 == Approx(2));
  CHECK(c.arap == Approx(0.2));
}

TEST_CASE("certificate: percentiles are those of all triangles in order") {
  for (const Index side : {2, 3, 17, 60}) {
    const Mesh mesh =
        shapes::height_field(side, [](double x, double y) { return 0.4 * std::sin(3 * x) * y; });
    shapes::Random random(7);
    auto uv = mapped(mesh, {1, 0.2, 0, 1});
    for (Vec2& z : uv) z += (0.3 / side) * Vec2{random.uniform(), random.uniform()};
    const Index num_triangles = mesh.num_triangles();
    std::vector<RestFrame> frame(num_triangles);
    rest_frames({0, num_triangles}, mesh.position, mesh.corner_vertex, frame);
    std::vector<Mat2> jacobian(num_triangles);
    std::vector<SingularValues> sigma(num_triangles);
    jacobians({0, num_triangles}, frame, uv, mesh.corner_vertex, jacobian);
    singular_values({0, num_triangles}, jacobian, sigma);
    std::vector<std::pair<double, double>> stretch;  // and area
    double total = 0;
    for (Index t = 0; t < num_triangles; ++t) {
      stretch.emplace_back(sigma[t].sigma_max, area(frame[t]));
      total += area(frame[t]);
    }
    std::sort(stretch.begin(), stretch.end());
    const auto at = [&](double share) {
      double below = 0;
      std::size_t i = 0;
      while (i + 1 < stretch.size() && below + stretch[i].second < share * total)
        below += stretch[i++].second;
      return stretch[i].first;
    };
    const Certificate c = certificate_of(mesh, uv);
    CHECK(c.sigma_max.p1 == at(0.01));
    CHECK(c.sigma_max.p50 == at(0.50));
    CHECK(c.sigma_max.p99 == at(0.99));
    CHECK(c.sigma_max.min == stretch.front().first);
    CHECK(c.sigma_max.max == stretch.back().first);
  }
}
