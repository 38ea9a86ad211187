#include "engine/embed.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "engine/prepare/topology.hpp"
#include "kernels/exact/orient2.hpp"
#include "tests/support/shapes.hpp"

using namespace planish;
using doctest::Approx;

namespace {

double area_of(const Surface& surface) {
  std::vector<double> area;
  for (Index t = 0; t < surface.num_triangles(); ++t) {
    const Index* v = &surface.corner_vertex[3 * t];
    area.push_back(0.5 * norm(cross(surface.position[v[1]] - surface.position[v[0]],
                                    surface.position[v[2]] - surface.position[v[0]])));
  }
  return pairwise_sum(area);
}

/// Barycentric coordinates of corners 1 and 2 of an input triangle, from what the embedding says alone.
Vec2 in_triangle(const Surface& input, const Embedding& embedding, Index v, Index t) {
  const auto corner = [&](Index vertex) {
    for (Index i = 0; i < 3; ++i) {
      if (input.corner_vertex[3 * t + i] == vertex) return i;
    }
    return kNone;
  };
  const Vec2 unit[3] = {{0, 0}, {1, 0}, {0, 1}};
  if (v < input.num_vertices()) {
    REQUIRE(corner(v) != kNone);
    return unit[corner(v)];
  }
  const SurfacePoint& at = embedding.vertex_origin[v - input.num_vertices()];
  if (at.triangle == t) return {at.barycentric.y, at.barycentric.z};
  const double b[3] = {at.barycentric.x, at.barycentric.y, at.barycentric.z};
  double in[3] = {0, 0, 0};
  for (Index i = 0; i < 3; ++i) {
    if (b[i] == 0) continue;
    const Index here = corner(input.corner_vertex[3 * at.triangle + i]);
    REQUIRE(here != kNone);  // the point lies on the common edge
    in[here] = b[i];
  }
  // On an edge the two coordinates sum to 1 exactly: whichever is kept, the other follows.
  return {in[1], in[2]};
}

void check_embedding(const Mesh& input, const Embedding& embedding) {
  const Surface surface = input.surface();
  REQUIRE(std::equal(input.position.begin(), input.position.end(), embedding.position.begin()));
  REQUIRE(embedding.position.size() == input.position.size() + embedding.vertex_origin.size());
  CHECK(std::abs(area_of(embedding.surface()) / area_of(surface) - 1) < 1e-12);

  std::vector<double> covered(surface.num_triangles(), 0);
  Index turned = 0;
  for (Index t = 0; t < embedding.surface().num_triangles(); ++t) {
    const Index origin = embedding.triangle_origin[t];
    Vec2 z[3];
    for (int i = 0; i < 3; ++i)
      z[i] = in_triangle(surface, embedding, embedding.corner_vertex[3 * t + i], origin);
    turned += orient2(z[0], z[1], z[2]) <= 0 ? 1 : 0;
    covered[origin] += cross(z[1] - z[0], z[2] - z[0]);
  }
  CHECK(turned == 0);
  for (const double share : covered) REQUIRE(share == Approx(1).epsilon(1e-12));

  for (std::size_t k = 0; k < embedding.vertex_origin.size(); ++k) {
    const auto& [t, b] = embedding.vertex_origin[k];
    const Index* v = &surface.corner_vertex[3 * t];
    const Vec3 p = b.x * surface.position[v[0]] + b.y * surface.position[v[1]] + b.z * surface.position[v[2]];
    REQUIRE(norm(p - embedding.position[surface.num_vertices() + k]) < 1e-14 * (1 + norm(p)));
  }

  const Exec exec(2);
  const Topology before = build_topology(exec, surface), after = build_topology(exec, embedding.surface());
  REQUIRE(after.manifold);
  CHECK(after.num_loops() == before.num_loops());
  CHECK(embedding.surface().num_vertices() - after.num_edges + embedding.surface().num_triangles() ==
        surface.num_vertices() - before.num_edges + surface.num_triangles());

  std::map<std::pair<Index, Index>, int> edges;
  for (Index c = 0; c < static_cast<Index>(embedding.corner_vertex.size()); ++c) {
    ++edges[std::minmax(embedding.corner_vertex[c], embedding.corner_vertex[next_corner(c)])];
  }
  for (const Feature& feature : embedding.features) {
    for (std::size_t i = 0; i + (feature.closed ? 0 : 1) < feature.vertex.size(); ++i) {
      const Index u = feature.vertex[i], v = feature.vertex[(i + 1) % feature.vertex.size()];
      REQUIRE(edges.count(std::minmax(u, v)) == 1);
    }
  }
}

FeatureSpec polyline(std::string name, std::vector<Vec3> point, bool closed = false,
                     double max_distance = 0.1) {
  return {std::move(name), PolylineSource{std::move(point), closed, max_distance}};
}

double saddle(double x, double y) { return 0.15 * (x * x - y * y); }
double waves(double x, double y) { return 0.1 * std::sin(3 * x) * std::cos(2 * y); }

}  // namespace

TEST_CASE("embed: a straight polyline over a flat mesh becomes a chain of its length on it") {
  const Mesh mesh = shapes::height_field(20, shapes::flat);
  ConstraintSet set;
  set.features = {polyline("line", {{-0.83, -0.41, 0}, {0.77, 0.52, 0}})};
  const auto embedding = embed(mesh.surface(), set);
  REQUIRE(embedding);
  check_embedding(mesh, *embedding);
  const Feature& line = embedding->features.front();
  CHECK(line.vertex.size() > 20);
  CHECK(line.length == Approx(std::hypot(1.6, 0.93)).epsilon(1e-6));
  CHECK(line.max_deviation < 1e-3);
}

TEST_CASE("embed: a closed polyline becomes a closed chain, and the triangles it encloses a region") {
  const Mesh mesh = shapes::height_field(24, saddle);
  std::vector<Vec3> circle;
  for (int k = 0; k < 40; ++k) {
    const double a = 2 * kPi * k / 40, x = 0.5 * std::cos(a), y = 0.5 * std::sin(a);
    circle.push_back({x, y, saddle(x, y)});
  }
  ConstraintSet set;
  set.features = {{"inside", EnclosedBySource{"ring", std::nullopt}}, polyline("ring", circle, true)};
  const auto embedding = embed(mesh.surface(), set);
  REQUIRE(embedding);
  check_embedding(mesh, *embedding);
  CHECK(embedding->features[1].closed);
  CHECK(embedding->features[1].length > 2 * kPi * 0.5);
  double area = 0;
  for (const Index t : embedding->features[0].triangle) {
    const Index* v = &embedding->corner_vertex[3 * t];
    const Vec3 n = cross(embedding->position[v[1]] - embedding->position[v[0]],
                         embedding->position[v[2]] - embedding->position[v[0]]);
    area += 0.5 * n.z;  // as seen from above: the 40-gon
  }
  CHECK(area == Approx(0.5 * 40 * 0.25 * std::sin(2 * kPi / 40)).epsilon(2e-3));
}

TEST_CASE("embed: polylines that cross share a vertex there") {
  const Mesh mesh = shapes::height_field(15, waves);
  ConstraintSet set;
  set.features = {polyline("u", {{-0.7, 0.03, 0}, {0.7, 0.05, 0}}, false, 0.2),
                  polyline("v", {{0.01, -0.7, 0}, {0.04, 0.7, 0}}, false, 0.2)};
  const auto embedding = embed(mesh.surface(), set);
  REQUIRE(embedding);
  check_embedding(mesh, *embedding);
  std::vector<Index> u = embedding->features[0].vertex, v = embedding->features[1].vertex, common;
  std::sort(u.begin(), u.end());
  std::sort(v.begin(), v.end());
  std::set_intersection(u.begin(), u.end(), v.begin(), v.end(), std::back_inserter(common));
  REQUIRE(common.size() == 1);
  CHECK(std::abs(embedding->position[common[0]].x) < 0.1);
  CHECK(std::abs(embedding->position[common[0]].y) < 0.1);
}

TEST_CASE("embed: a polyline along mesh edges through vertices adds nothing") {
  const Mesh mesh = shapes::height_field(11, shapes::flat, 0);
  ConstraintSet set;
  set.features = {polyline("row", {{-0.8, 0, 0}, {0.8, 0, 0}})};
  const auto embedding = embed(mesh.surface(), set);
  REQUIRE(embedding);
  CHECK(embedding->vertex_origin.empty());
  CHECK(embedding->features[0].vertex.size() == 9);
  CHECK(embedding->features[0].length == Approx(1.6));
}

TEST_CASE("embed: two thousand random polylines on twenty random meshes keep every promise") {
  shapes::Random random(2024);
  Index embedded = 0, refused = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const auto height = trial % 3 == 0 ? shapes::flat : trial % 3 == 1 ? saddle : waves;
    const Index n = 6 + static_cast<Index>(random.uniform() * 30);
    const Mesh mesh = shapes::height_field(n, height, trial % 5 == 0 ? 0 : 0.3);
    const auto place = [&](double x, double y) {
      return Vec3{x, y, height(x, y) + 0.002 * (random.uniform() - 0.5)};
    };
    ConstraintSet set;
    for (int k = 0; k < 100; ++k) {
      std::vector<Vec3> points;
      const int kind = k % 5;
      const double x = 1.4 * random.uniform() - 0.7, y = 1.4 * random.uniform() - 0.7;
      if (kind == 0) {  // a straight line of several points, left to right
        const double slope = random.uniform() - 0.5;
        for (int i = 0; i < 6; ++i)
          points.push_back(place(-0.7 + 0.28 * i, 0.5 * y + slope * (-0.7 + 0.28 * i)));
      } else if (kind == 1) {  // a small closed curve, counter-clockwise
        const int sides = 3 + static_cast<int>(random.uniform() * 20);
        const double r = 0.02 + 0.2 * random.uniform();
        for (int i = 0; i < sides; ++i) {
          points.push_back(
              place(x + r * std::cos(2 * kPi * i / sides), y + r * std::sin(2 * kPi * i / sides)));
        }
      } else if (kind == 2) {  // through vertices: a row of them
        const Index row = static_cast<Index>(random.uniform() * (n - 2)) + 1;
        for (Index i = 1; i + 1 < n; i += 2) points.push_back(mesh.position[row * n + i]);
        if (points.size() < 2) points.push_back(mesh.position[row * n + n - 2]);
      } else if (kind == 3) {  // nearly the same as the one before, but for 1e-7
        const auto& before = std::get<PolylineSource>(set.features.back().source).point;
        for (const Vec3 p : before)
          points.push_back(p + Vec3{1e-7 * random.uniform(), 1e-7 * random.uniform(), 0});
      } else {  // a random walk to the right
        double at_x = -0.8, at_y = y;
        while (at_x < 0.7) {
          points.push_back(place(at_x, at_y));
          at_x += 0.02 + 0.2 * random.uniform();
          at_y = std::clamp(at_y + 0.4 * (random.uniform() - 0.5), -0.8, 0.8);
        }
      }
      set.features.push_back(polyline("p" + std::to_string(k), points, kind == 1, 0.2));
    }
    // Features that run against one another are refused by design: leave out the one that is named, and go on.
    while (true) {
      const auto embedding = embed(mesh.surface(), set);
      if (embedding) {
        check_embedding(mesh, *embedding);
        embedded += static_cast<Index>(set.features.size());
        for (const Feature& feature : embedding->features) CHECK(feature.max_deviation <= 0.2 + 1e-9);
        break;
      }
      const std::string pointer = embedding.error().place.pointer;
      CAPTURE(describe(embedding.error()));
      const bool by_design = embedding.error().code == ErrorCode::FeaturesOverlap ||
                             embedding.error().code == ErrorCode::FeatureBroken;
      REQUIRE(by_design);
      std::erase_if(set.features,
                    [&](const FeatureSpec& spec) { return "/features/" + spec.name == pointer; });
      ++refused;
    }
  }
  MESSAGE(embedded << " embedded, " << refused << " refused");
  CHECK(embedded > 1980);
}

namespace {

Error refused(const Mesh& mesh, std::vector<FeatureSpec> features) {
  ConstraintSet set;
  set.features = std::move(features);
  const auto embedding = embed(mesh.surface(), set);
  REQUIRE(!embedding);
  return embedding.error();
}

}  // namespace

TEST_CASE("embed: what is no curve on the surface is refused with feature and points named") {
  const Mesh sheet = shapes::height_field(11, shapes::flat);
  const double nan = std::nan("");
  const auto expect = [](const Error& error, ErrorCode code, std::vector<Index> ids, const char* pointer) {
    CAPTURE(describe(error));
    CHECK(error.code == code);
    CHECK(error.ids == ids);
    CHECK(error.place.pointer == pointer);
    CHECK(exit_code(error.code) == 5);
  };
  expect(refused(sheet, {polyline("a/b", {{0, 0, 0}})}), ErrorCode::FeatureBroken, {}, "/features/a~1b");
  expect(refused(sheet, {polyline("p", {})}), ErrorCode::FeatureBroken, {}, "/features/p");
  expect(refused(sheet, {polyline("p", {{0, 0, 0}, {0.5, 0, 0}, {0.5, 0, 0}})}), ErrorCode::FeatureBroken,
         {2}, "/features/p");
  expect(refused(sheet, {polyline("p", {{0, 0, 0}, {0.5, nan, 0}})}), ErrorCode::FeatureBroken, {1},
         "/features/p");
  expect(refused(sheet, {polyline("p", {{0, 0, 0}, {0.5, 0, 0.3}})}), ErrorCode::FeatureTooFar, {1},
         "/features/p");
  expect(refused(sheet, {polyline("p", {{0, 0, 0}, {0.5, 0, 0}, {0.1, 0, 0}})}), ErrorCode::FeatureBroken,
         {1, 2}, "/features/p");
  expect(refused(shapes::frame(17, shapes::flat), {polyline("p", {{-0.9, 0.01, 0}, {0.9, 0.01, 0}})}),
         ErrorCode::FeatureLeavesSurface, {0, 1}, "/features/p");
  Mesh above = sheet;
  for (Vec3& p : above.position) p.z += 3;
  expect(refused(shapes::joined(sheet, above), {polyline("p", {{0, 0, 0}, {0.2, 0, 0}, {0.4, 0, 3}})}),
         ErrorCode::FeatureLeavesSurface, {2}, "/features/p");
}

TEST_CASE(
    "embed: chains that run against one another along an edge are refused, along with one another not") {
  const Mesh mesh = shapes::height_field(11, shapes::flat, 0);
  const auto row = [](std::vector<Index> v) { return VertexSource{std::move(v), false, false}; };
  const Error error = refused(mesh, {{"a", row({56, 57, 58})}, {"b", row({59, 58, 57})}});
  CHECK(error.code == ErrorCode::FeaturesOverlap);
  CHECK(error.count == 1);
  ConstraintSet set;
  set.features = {{"a", row({56, 57, 58})}, {"b", row({57, 58, 59})}};
  CHECK(embed(mesh.surface(), set));
}

TEST_CASE("embed: the result has the same bits on 1, 2 and 7 threads") {
  const Mesh mesh = shapes::height_field(40, waves);
  ConstraintSet set;
  for (int k = 0; k < 20; ++k) {
    const double y = -0.75 + 0.075 * k;
    set.features.push_back(
        polyline("p" + std::to_string(k),
                 {{-0.8, y, waves(-0.8, y)}, {0.1, y / 2, waves(0.1, y / 2)}, {0.8, -y, waves(0.8, -y)}}));
  }
  const auto one = embed(mesh.surface(), set, {.threads = 1});
  REQUIRE(one);
  for (const int threads : {2, 7}) {
    const auto other = embed(mesh.surface(), set, {.threads = threads});
    REQUIRE(other);
    CHECK(other->position == one->position);
    CHECK(other->corner_vertex == one->corner_vertex);
    for (std::size_t k = 0; k < set.features.size(); ++k)
      CHECK(other->features[k].vertex == one->features[k].vertex);
  }
}

TEST_CASE("embed: unused vertices and far, tiny meshes keep the same chains") {
  const Mesh mesh = shapes::height_field(20, saddle);
  const auto chain_of = [](const Mesh& m, Vec3 shift, double scale) {
    ConstraintSet set;
    std::vector<Vec3> points;
    for (const double x : {-0.7, -0.1, 0.65})
      points.push_back(scale * Vec3{x, 0.3 * x, saddle(x, 0.3 * x)} + shift);
    set.features = {polyline("p", points, false, 0.1 * scale)};
    const auto embedding = embed(m.surface(), set);
    REQUIRE(embedding);
    return embedding->features[0];
  };
  const Feature plain = chain_of(mesh, {}, 1);
  Mesh unused = mesh;
  unused.position.push_back({5, 5, 5});
  Feature beside = chain_of(unused, {}, 1);
  for (Index& v : beside.vertex) v -= v >= unused.num_vertices() ? 1 : 0;
  CHECK(beside.vertex == plain.vertex);
  Mesh tiny = mesh;
  for (Vec3& p : tiny.position) p = 0x1p-30 * p;
  CHECK(chain_of(tiny, {}, 0x1p-30).vertex == plain.vertex);
  Mesh far = mesh;
  for (Vec3& p : far.position) p = p + Vec3{4096, -4096, 4096};
  CHECK(chain_of(far, {4096, -4096, 4096}, 1).length == Approx(plain.length).epsilon(1e-6));
}

TEST_CASE("embed: a polyline that retraces its way step by step is refused, however small the steps") {
  const Mesh mesh = shapes::height_field(41, shapes::flat, 0.2);
  std::vector<Vec3> there_and_back;
  for (int k = 0; k <= 40; ++k) there_and_back.push_back({-0.5 + 0.02 * k, 0.01, 0});
  for (int k = 1; k <= 30; ++k) there_and_back.push_back({0.3 - 0.02 * k, 0.01, 0});
  const Error error = refused(mesh, {polyline("p", there_and_back, false, 1)});
  CHECK(error.code == ErrorCode::FeatureBroken);
  CHECK(error.what.find("turns back") != std::string::npos);
}

TEST_CASE("embed: constraints that name what the mesh does not have are refused with their place") {
  const Mesh mesh = shapes::height_field(5, shapes::flat, 0);
  const auto error_of = [&](auto rule) {
    ConstraintSet set;
    set.features = {{"row", VertexSource{{0, 1, 2}, false, false}}};
    set.constraints = {{"first", "line", LineConstraint{.feature = "row", .scale = {}}},
                       {"second", "x", rule}};
    const auto embedding = embed(mesh.surface(), set);
    REQUIRE(!embedding);
    CHECK(embedding.error().code == ErrorCode::ConstraintInvalid);
    return embedding.error();
  };
  const Error pin = error_of(PinConstraint{{3, 999}, {{0, 0}, {1, 0}}});
  CHECK(pin.place.pointer == "/constraints/1/vertices/1");
  CHECK(pin.ids == std::vector<Index>{999});
  AngleConstraint angle;
  angle.edges = {{0, 1}, {0, 24}};
  CHECK(error_of(angle).ids == std::vector<Index>{0, 24});
  angle.edges = {{0, 1}, {0, -1}};
  CHECK(error_of(angle).place.pointer == "/constraints/1/edges/1/1");
}

TEST_CASE("embed: many points in one triangle add vertices in proportion, and no slivers but their own") {
  const Mesh mesh = shapes::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  std::vector<Vec3> wave;
  constexpr int kPoints = 300;
  for (int k = 0; k < kPoints; ++k) {
    const double x = 0.05 + 0.5 * k / kPoints;
    wave.push_back({x, 0.2 + 0.1 * std::sin(40 * x), 0});
  }
  ConstraintSet set;
  set.features = {polyline("wave", wave), polyline("across", {{0.1, 0.15, 0}, {0.6, 0.25, 0}})};
  const auto embedding = embed(mesh.surface(), set);
  REQUIRE(embedding);
  check_embedding(mesh, *embedding);
  CHECK(embedding->vertex_origin.size() < kPoints + 40);
}
