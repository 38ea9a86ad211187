#include "engine/features/project.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/shapes.hpp"

using namespace planish;
using shapes::Random;

namespace {

PolylineSource curve(std::vector<Vec3> point, bool closed = false, std::optional<double> max_distance = {}) {
  return {std::move(point), closed, max_distance};
}

/// A mesh with all that project() wants to know of it.
struct Prepared {
  Mesh mesh;
  Exec exec;
  Topology topology;
  SurfaceLocator locator;
  explicit Prepared(Mesh m, int threads = 2)
      : mesh(std::move(m)),
        exec(threads),
        topology(build_topology(exec, mesh.surface())),
        locator(exec, mesh.surface()) {}
  Result<Projection> project(const PolylineSource& source) const {
    return planish::project(exec, mesh.surface(), topology, locator, FeatureSpec{"curve", source});
  }
};

/// Quads between rows of points, two triangles each.
Mesh strip_of(Index rows, Index columns, auto&& point) {
  Mesh mesh;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) mesh.position.push_back(point(i, j));
  }
  for (Index i = 0; i + 1 < rows; ++i) {
    for (Index j = 0; j + 1 < columns; ++j) {
      const Index a = i * columns + j, b = a + 1, c = a + columns, d = c + 1;
      mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, c, b, b, c, d});
    }
  }
  return mesh;
}

constexpr double kGap = 0.3;

/// A plate of 100 mm by 60 mm in z = 0, folded back around x = 100 and above itself to x = 60; 1 mm mesh.
Mesh folded_flange() {
  const auto profile = [](Index i) -> Vec3 {
    if (i <= 100) return {static_cast<double>(i), 0, 0};
    if (i < 106) {
      const double angle = kPi * (i - 100) / 6;
      return {100 + 0.5 * kGap * std::sin(angle), 0, 0.5 * kGap * (1 - std::cos(angle))};
    }
    return {100.0 - (i - 106), 0, kGap};
  };
  return strip_of(147, 61, [&](Index i, Index j) { return profile(i) + Vec3{0, static_cast<double>(j), 0}; });
}

/// Points at x, y with noise in z between lowest and highest.
std::vector<Vec3> noisy_line(Vec3 from, Vec3 to, Index n, double lowest, double highest, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> point;
  for (Index i = 0; i < n; ++i) {
    Vec3 p = from + (i / (n - 1.0)) * (to - from);
    p.z += lowest + (highest - lowest) * random.uniform();
    point.push_back(p);
  }
  return point;
}

/// Every projection lies at height z, straight above or below its point.
void check_on_sheet(const Result<Projection>& projection, const std::vector<Vec3>& point, double z) {
  REQUIRE(projection);
  REQUIRE(projection->position.size() == point.size());
  for (std::size_t i = 0; i < point.size(); ++i) {
    CHECK(projection->position[i].z == doctest::Approx(z).epsilon(1e-14));
    CHECK(norm(projection->position[i] - Vec3{point[i].x, point[i].y, z}) < 1e-12);
  }
}

Index nearer_to_upper(const std::vector<Vec3>& point) {
  return static_cast<Index>(std::ranges::count_if(point, [](Vec3 p) { return p.z > kGap / 2; }));
}

}  // namespace

TEST_CASE("project: points of a smooth surface go to their closest points") {
  const Prepared p(shapes::wavy_disk(4000));
  Random random(3);
  PolylineSource source;
  for (int i = 0; i < 40; ++i) {
    const double a = 2 * kPi * i / 40;
    source.point.push_back(p.locator.nearest({0.5 * std::cos(a), 0.5 * std::sin(a), 0}).position +
                           0.01 * Vec3{random.uniform(), random.uniform(), random.uniform()});
  }
  source.max_distance = 0.05;
  for (const bool closed : {false, true}) {
    source.closed = closed;
    const auto projection = p.project(source);
    REQUIRE(projection);
    double farthest = 0;
    for (std::size_t i = 0; i < source.point.size(); ++i) {
      const auto nearest = p.locator.nearest(source.point[i]);
      CHECK(projection->position[i] == nearest.position);
      CHECK(projection->at[i].triangle == nearest.at.triangle);
      farthest = std::max(farthest, nearest.distance);
    }
    CHECK(projection->max_distance == farthest);
  }
}

TEST_CASE("project: a long step over a strongly curved surface is no change of sheet") {
  const Mesh arch = strip_of(101, 41, [](Index i, Index j) {
    const double a = 0.95 * kPi * i / 100;
    return Vec3{std::cos(a), 0.05 * j, std::sin(a)};
  });
  const Prepared p(arch);
  for (const int steps : {1, 2, 3, 7}) {
    PolylineSource source = curve({}, false, 0.2);
    for (int k = 0; k <= steps; ++k) {
      const double a = 0.9 * kPi * k / steps + 0.02;
      source.point.push_back({1.05 * std::cos(a), 0.5 + 0.1 * k, 1.05 * std::sin(a)});
    }
    const auto projection = p.project(source);
    REQUIRE(projection);
    for (int k = 0; k <= steps; ++k)
      CHECK(projection->position[k] == p.locator.nearest(source.point[k]).position);
  }
}

TEST_CASE("project: a noisy curve on a folded flange stays on its sheet") {
  const Prepared p(folded_flange());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const bool along = seed % 2 == 0;
    const Vec3 from = along ? Vec3{62.3, 20.2, 0} : Vec3{90.3, 2.1, 0};
    const Vec3 to = along ? Vec3{94.1, 31.7, 0} : Vec3{88.2, 57.9, 0};
    const auto lower = noisy_line(from, to, 50, -0.1, 0.22, seed);
    CHECK(nearer_to_upper(lower) > 2);
    check_on_sheet(p.project(curve(lower)), lower, 0);
    const auto upper = noisy_line(from, to, 50, 0.08, 0.4, seed);
    CHECK(nearer_to_upper(upper) < 48);
    check_on_sheet(p.project(curve(upper)), upper, kGap);
  }
}

TEST_CASE("project: ends drawn nearer to the wrong sheet do not decide") {
  const Prepared p(folded_flange());
  auto line = noisy_line({90.3, 2.1, 0}, {88.2, 57.9, 0}, 30, -0.02, 0.02, 9);
  for (const std::size_t i : {0, 1, 15, 28, 29}) line[i].z = 0.2;
  check_on_sheet(p.project(curve(line)), line, 0);
  std::ranges::reverse(line);
  check_on_sheet(p.project(curve(line)), line, 0);
}

TEST_CASE("project: a closed curve on a folded flange stays on its sheet") {
  const Prepared p(folded_flange());
  Random random(4);
  std::vector<Vec3> ring;
  for (int i = 0; i < 80; ++i) {
    const double a = 2 * kPi * i / 80;
    ring.push_back({80 + 12 * std::cos(a), 30 + 12 * std::sin(a), -0.1 + 0.32 * random.uniform()});
  }
  CHECK(nearer_to_upper(ring) > 2);
  check_on_sheet(p.project(curve(ring, true)), ring, 0);
  std::ranges::rotate(ring, std::ranges::find_if(ring, [](Vec3 q) { return q.z > kGap / 2; }));
  check_on_sheet(p.project(curve(ring, true)), ring, 0);
}

TEST_CASE("project: a curve drawn around the fold follows it") {
  const Prepared p(folded_flange());
  PolylineSource source = curve({}, false, 0.1);
  for (int i = 0; i <= 20; ++i) source.point.push_back({90.05 + 0.5 * i, 30.3, 0.01});
  source.point.push_back({100.16, 30.3, kGap / 2});
  for (int i = 20; i >= 0; --i) source.point.push_back({90.05 + 0.5 * i, 30.3, kGap - 0.01});
  const auto projection = p.project(source);
  REQUIRE(projection);
  CHECK(projection->position[3].z == 0);
  CHECK(projection->position[39].z == kGap);
  for (std::size_t i = 0; i < source.point.size(); ++i)
    CHECK(projection->position[i] == p.locator.nearest(source.point[i]).position);
}

TEST_CASE("project: of two plates close together one is chosen for the whole curve") {
  Mesh above = shapes::height_field(21, shapes::flat);
  for (Vec3& q : above.position) q.z = 0.003;
  const Prepared p(shapes::joined(shapes::height_field(21, shapes::flat), above));
  auto line = noisy_line({-0.8, -0.3, 0}, {0.7, 0.4, 0}, 40, -0.001, 0.0022, 5);
  line[0].z = 0.002;
  check_on_sheet(p.project(curve(line)), line, 0);
}

TEST_CASE("project: points on another component are named") {
  Mesh beside = shapes::height_field(11, shapes::flat);
  for (Vec3& q : beside.position) q.x += 2.1;
  const Prepared p(shapes::joined(shapes::height_field(11, shapes::flat), beside));
  PolylineSource source = curve({}, false, 0.05);
  for (int i = 0; i < 10; ++i) source.point.push_back({-0.72 + 0.25 * i, 0.1, 0.001});
  const auto projection = p.project(source);
  REQUIRE(!projection);
  CHECK(projection.error().code == ErrorCode::FeatureLeavesSurface);
  CHECK(projection.error().element == ElementKind::Point);
  CHECK(projection.error().ids == std::vector<Index>{8, 9});
  CHECK(projection.error().count == 2);
  CHECK(projection.error().what.find("\"curve\"") != std::string::npos);
  CHECK(projection.error().what.find("point 8 lies on another component") != std::string::npos);
}

TEST_CASE("project: a hole between two points is left to the tracer") {
  const Prepared p(shapes::frame(31, shapes::flat));
  const PolylineSource source = curve({{-0.9, 0.03, 0.01}, {-0.8, 0.02, 0}, {0.8, 0, -0.01}, {0.9, 0, 0}});
  check_on_sheet(p.project(source), source.point, 0);
}

TEST_CASE("project: points farther away than max_distance are named, with the worst one's distance") {
  const Prepared p(shapes::height_field(21, shapes::flat));
  PolylineSource source =
      curve({{-0.5, 0, 0.01}, {-0.2, 0, 0.3}, {0.1, 0, 0}, {0.4, 0, -0.5}, {0.5, 0, 0.1}});
  source.max_distance = 0.1;
  auto refused = p.project(source);
  REQUIRE(!refused);
  CHECK(refused.error().code == ErrorCode::FeatureTooFar);
  CHECK(refused.error().element == ElementKind::Point);
  CHECK(refused.error().ids == std::vector<Index>{1, 3});
  CHECK(refused.error().what == "feature \"curve\": point 3 is 0.5 from the surface, 0.1 allowed");
  source.max_distance = 0.5;
  CHECK(p.project(source)->max_distance == 0.5);
}

TEST_CASE("project: the default max_distance is 1% of the length, with the closing segment") {
  const Prepared p(shapes::height_field(21, shapes::flat));
  PolylineSource source = curve({{-0.5, 0, 0.011}, {0.5, 0, 0.011}});
  CHECK(!p.project(source));
  source.point.push_back({0, 0.5, 0.011});  // 1 + 0.707 open, 2.414 closed
  for (Vec3& q : source.point) q.z = 0.02;
  CHECK(p.project(source).error().ids == std::vector<Index>{0, 1, 2});
  source.closed = true;
  CHECK(p.project(source));
}

TEST_CASE("project: many ids are cut at the limit, all are counted") {
  const Prepared p(shapes::height_field(5, shapes::flat));
  const auto line = noisy_line({-1, 0, 1}, {1, 0, 1}, 200, 0, 0.1, 1);
  const auto refused = p.project(curve(line));
  REQUIRE(!refused);
  CHECK(refused.error().ids.size() == kMaxListedIds);
  CHECK(refused.error().count == 200);
}

TEST_CASE("project: what is no polyline of distinct finite points is refused") {
  const Prepared p(shapes::height_field(5, shapes::flat));
  const auto refusal = [&](PolylineSource source) {
    const auto refused = p.project(source);
    REQUIRE(!refused);
    CHECK(refused.error().code == ErrorCode::FeatureBroken);
    CHECK(refused.error().what.find("\"curve\"") != std::string::npos);
    return refused.error();
  };
  const Vec3 a{0, 0, 0}, b{0.5, 0, 0}, c{0, 0.5, 0};
  refusal({});
  refusal(curve({a}));
  refusal(curve({a, b}, true));
  CHECK(refusal(curve({a, {0, std::nan(""), 0}, b, {kInfinity, 0, 0}})).ids == std::vector<Index>{1, 3});
  CHECK(refusal(curve({a, a, b, c, c})).ids == std::vector<Index>{1, 4});
  CHECK(refusal(curve({a, b, c, a}, true)).ids == std::vector<Index>{0});
  const auto other =
      project(p.exec, p.mesh.surface(), p.topology, p.locator, FeatureSpec{"rim", LoopSource{0}});
  REQUIRE(!other);
  CHECK(other.error().code == ErrorCode::BadUsage);
}

TEST_CASE("project: of several polylines that fail the first is the error, the others are named") {
  const Prepared p(shapes::height_field(5, shapes::flat));
  const PolylineSource good = curve({{0, 0, 0}, {0.5, 0, 0}}), far = curve({{0, 0, 9}, {0.5, 0, 0}});
  const std::vector<FeatureSpec> specs = {{"a", good}, {"b", far}, {"c", LoopSource{0}}, {"d", far}};
  const auto refused = project(p.exec, p.mesh.surface(), p.topology, p.locator, specs);
  REQUIRE(!refused);
  CHECK(refused.error().what.find("\"b\"") != std::string::npos);
  CHECK(refused.error().also.find("\"d\"") != std::string::npos);
  const auto rest =
      project(p.exec, p.mesh.surface(), p.topology, p.locator, In<FeatureSpec>(specs).subspan(2, 1));
  REQUIRE(rest);
  CHECK(rest->at(0).at.empty());
}

TEST_CASE("project: far coordinates and tiny units choose the same sheet") {
  const auto line = noisy_line({90.3, 2.1, 0}, {88.2, 57.9, 0}, 40, -0.1, 0.22, 7);
  Mesh far = folded_flange();
  auto far_line = line;
  const Vec3 offset{1e6, 1e6, -1e6};
  for (Vec3& q : far.position) q = q + offset;
  for (Vec3& q : far_line) q = q + offset;
  const Prepared far_away(far), tiny(shapes::scaled(folded_flange(), 1e-9));
  auto tiny_line = line;
  for (Vec3& q : tiny_line) q = 1e-9 * q;
  const auto at_far = far_away.project(curve(far_line)), at_tiny = tiny.project(curve(tiny_line));
  REQUIRE(at_far);
  REQUIRE(at_tiny);
  for (std::size_t i = 0; i < line.size(); ++i) {
    CHECK(std::abs(at_far->position[i].z - offset.z) < 1e-9);
    CHECK(std::abs(at_tiny->position[i].z) < 1e-20);
  }
}

TEST_CASE("project: 1, 2 and 7 threads give the same bits") {
  std::vector<FeatureSpec> specs;
  for (std::uint64_t k = 0; k < 30; ++k) {
    const double y = 2.1 + 1.7 * static_cast<double>(k);
    specs.push_back({"line", curve(noisy_line({61.2, y, 0}, {96.3, y + 5, 0}, 40, -0.1, 0.22, k))});
  }
  const auto run = [&](int threads) {
    const Prepared p(folded_flange(), threads);
    auto all = project(p.exec, p.mesh.surface(), p.topology, p.locator, specs);
    REQUIRE(all);
    return std::move(*all);
  };
  const auto one = run(1);
  for (const int threads : {2, 7}) {
    const auto other = run(threads);
    for (std::size_t k = 0; k < one.size(); ++k) {
      CHECK(other[k].position == one[k].position);
      CHECK(other[k].max_distance == one[k].max_distance);
    }
  }
}
