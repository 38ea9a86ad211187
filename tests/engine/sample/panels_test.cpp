#include "engine/sample/panels.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

using namespace planish;

namespace {

Sample sample_of(const std::string& kind, Index triangles, double noise = 0, std::uint64_t seed = 1,
                 int threads = 1) {
  const Exec exec(threads);
  auto sample = make_sample(exec, {.kind = kind, .triangles = triangles, .noise = noise, .seed = seed});
  REQUIRE(sample.has_value());
  return *std::move(sample);
}

/// Everything about connectivity that a sample promises; directed edges used twice or fans torn apart are
/// counted.
struct Topology {
  Index euler = 0, components = 0, loops = 0;
  Index broken_edges = 0, broken_vertices = 0, unused_vertices = 0;
  std::vector<char> on_border;
};

Topology topology_of(const Mesh& mesh) {
  Topology result;
  std::map<std::pair<Index, Index>, Index> corner_of;  // directed edges
  for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
    const Index v = mesh.corner_vertex[c], w = mesh.corner_vertex[next_corner(c)];
    if (v == w || !corner_of.insert({{v, w}, c}).second) ++result.broken_edges;
  }
  const Index num_vertices = mesh.num_vertices();
  std::vector<Index> next_on_border(num_vertices, kNone), corners(num_vertices, 0),
      any_corner(num_vertices, kNone);
  std::vector<Index> group(mesh.num_triangles());
  for (Index t = 0; t < mesh.num_triangles(); ++t) group[t] = t;
  const auto root = [&](Index t) {
    while (group[t] != t) t = group[t] = group[group[t]];
    return t;
  };
  Index edges = 0;
  result.on_border.assign(num_vertices, 0);
  for (const auto& [edge, corner] : corner_of) {
    const auto twin = corner_of.find({edge.second, edge.first});
    edges += twin == corner_of.end() || edge.first < edge.second;
    ++corners[edge.first];
    if (any_corner[edge.first] == kNone) any_corner[edge.first] = corner;
    if (twin != corner_of.end()) {
      group[root(corner / 3)] = root(twin->second / 3);
      continue;
    }
    if (next_on_border[edge.first] != kNone) ++result.broken_vertices;
    next_on_border[edge.first] = edge.second;
    any_corner[edge.first] = corner;  // fans of the border are walked from their first edge
    result.on_border[edge.first] = result.on_border[edge.second] = 1;
  }
  for (Index v = 0; v < num_vertices; ++v) {
    if (any_corner[v] == kNone) {
      ++result.unused_vertices;
      continue;
    }
    Index fan = 0, c = any_corner[v];
    do {  // counter-clockwise around v
      ++fan;
      const Index back = previous_corner(c);
      const auto twin = corner_of.find({v, mesh.corner_vertex[back]});
      c = twin == corner_of.end() ? kNone : twin->second;
    } while (c != kNone && c != any_corner[v] && fan <= corners[v]);
    result.broken_vertices += fan != corners[v];
  }
  for (Index t = 0; t < mesh.num_triangles(); ++t) result.components += root(t) == t;
  std::vector<char> seen(num_vertices, 0);
  for (Index v = 0; v < num_vertices; ++v) {
    if (next_on_border[v] == kNone || seen[v]) continue;
    ++result.loops;
    for (Index w = v; w != kNone && !seen[w]; w = next_on_border[w]) seen[w] = 1;
  }
  result.euler = num_vertices - result.unused_vertices - edges + mesh.num_triangles();
  return result;
}

Vec3 corner_position(const Mesh& mesh, Index c) { return mesh.position[mesh.corner_vertex[c]]; }

Vec3 doubled_area_normal(const Mesh& mesh, Index t) {
  const Vec3 a = corner_position(mesh, 3 * t);
  return cross(corner_position(mesh, 3 * t + 1) - a, corner_position(mesh, 3 * t + 2) - a);
}

double corner_angle(const Mesh& mesh, Index c) {
  const Vec3 p = corner_position(mesh, c);
  const Vec3 a = corner_position(mesh, next_corner(c)) - p, b = corner_position(mesh, previous_corner(c)) - p;
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t) sum += norm(doubled_area_normal(mesh, t)) / 2;
  return sum;
}

bool same_bits(const Sample& a, const Sample& b) {
  return a.mesh.corner_vertex == b.mesh.corner_vertex && a.mesh.position.size() == b.mesh.position.size() &&
         std::memcmp(a.mesh.position.data(), b.mesh.position.data(), a.mesh.position.size() * sizeof(Vec3)) ==
             0;
}

const std::vector<std::string> kDevelopable = {"cylinder", "cone", "tangent-developable"};

/// Squared distance from p to a triangle's plane region, by projection onto its edges and inside.
double distance_to_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const auto inside = [&](Vec3 v, Vec3 w) { return dot(cross(w - v, p - v), n) >= 0; };
  if (inside(a, b) && inside(b, c) && inside(c, a)) return std::abs(dot(p - a, n)) / norm(n);
  double best = kInfinity;
  for (const auto& [v, w] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
    const double s = std::clamp(dot(p - v, w - v) / dot(w - v, w - v), 0.0, 1.0);
    best = std::min(best, norm(p - v - s * (w - v)));
  }
  return best;
}

}  // namespace

TEST_CASE("sample: every kind and size is one manifold sheet with its boundary loops") {
  for (const std::string& kind : sample_kinds()) {
    const Index loops = kind == "annulus" ? 2 : 1;
    for (Index triangles : {32, 33, 37, 50, 100, 1000, 57000}) {
      CAPTURE(kind);
      CAPTURE(triangles);
      const Sample sample = sample_of(kind, triangles);
      const Topology topology = topology_of(sample.mesh);
      CHECK(topology.broken_edges == 0);
      CHECK(topology.broken_vertices == 0);
      CHECK(topology.unused_vertices == 0);
      CHECK(topology.components == 1);
      CHECK(topology.loops == loops);
      CHECK(topology.euler == 2 - loops);
      CHECK(std::abs(sample.mesh.num_triangles() - triangles) <= 0.05 * triangles);
    }
  }
}

TEST_CASE("sample: angles are those of a remeshed scan, at any size and seed") {
  constexpr double kDegree = kPi / 180;
  for (const std::string& kind : sample_kinds()) {
    for (const auto& [triangles, seeds] :
         {std::pair<Index, std::uint64_t>{32, 40}, {61, 40}, {500, 20}, {20000, 2}}) {
      CAPTURE(kind);
      CAPTURE(triangles);
      double smallest = kPi;
      Offset usual = 0, all = 0;
      for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Sample sample = sample_of(kind, triangles, 0, seed);
        for (Index c = 0; c < static_cast<Index>(sample.mesh.corner_vertex.size()); ++c) {
          const double angle = corner_angle(sample.mesh, c);
          smallest = std::min(smallest, angle);
          usual += angle > 30 * kDegree && angle < 100 * kDegree;
          ++all;
        }
      }
      CHECK(smallest > (triangles < 500 ? 5 : 10) * kDegree);
      CHECK(static_cast<double>(usual) > (triangles < 500 ? 0.7 : 0.85) * static_cast<double>(all));
    }
  }
}

TEST_CASE("sample: inner vertices have from four to eight neighbours, and not all six") {
  const Sample sample = sample_of("hood", 20000);
  const Topology topology = topology_of(sample.mesh);
  std::vector<Index> valence(sample.mesh.num_vertices(), 0);
  for (Index v : sample.mesh.corner_vertex) ++valence[v];
  Index inner = 0, regular = 0;
  for (Index v = 0; v < sample.mesh.num_vertices(); ++v) {
    if (topology.on_border[v]) continue;
    ++inner;
    regular += valence[v] == 6;
    CHECK((valence[v] >= 4 && valence[v] <= 8));
  }
  CHECK(regular < 0.8 * inner);
}

TEST_CASE("sample: normals point outward") {
  const auto check = [](const std::string& kind, auto&& outward) {
    CAPTURE(kind);
    for (Index triangles : {32, 3000}) {
      const Mesh mesh = sample_of(kind, triangles).mesh;
      Index inward = 0;
      for (Index t = 0; t < mesh.num_triangles(); ++t) {
        inward += dot(doubled_area_normal(mesh, t), outward(corner_position(mesh, 3 * t))) <= 0;
      }
      CHECK(inward == 0);
    }
  };
  const auto up = [](Vec3) { return Vec3{0, 0, 1}; };
  const auto from_axis = [](Vec3 p) { return Vec3{p.x, p.y, 0}; };
  check("hood", up);
  check("annulus", up);
  check("sphere-cap", [](Vec3 p) { return p; });
  check("cylinder", from_axis);
  check("cone", from_axis);
  check("door", [](Vec3) { return Vec3{0, -1, 0}; });  // the left one
}

TEST_CASE("sample: doors and fenders bulge outward") {
  for (const std::string kind : {"door", "fender"}) {
    const Mesh mesh = sample_of(kind, 3000).mesh;
    const auto outermost = std::min_element(mesh.position.begin(), mesh.position.end(),
                                            [](const Vec3& p, const Vec3& q) { return p.y < q.y; });
    CHECK_FALSE(topology_of(mesh).on_border[outermost - mesh.position.begin()]);
  }
}

TEST_CASE("sample: borders are smooth, their vertices on the curves") {
  const auto check = [](const std::string& kind, auto&& offset) {
    CAPTURE(kind);
    const Mesh mesh = sample_of(kind, 3000).mesh;
    const Topology topology = topology_of(mesh);
    double largest = 0;
    for (Index v = 0; v < mesh.num_vertices(); ++v) {
      if (topology.on_border[v]) largest = std::max(largest, std::abs(offset(mesh.position[v])));
    }
    CHECK(largest < 1e-12);
  };
  check("annulus", [](Vec3 p) { return norm(p) < 0.7 ? norm(p) - 0.4 : norm(p) - 1; });
  check("sphere-cap", [](Vec3 p) { return p.z - 0.5 * std::cos(0.9); });
}

TEST_CASE("sample: developable kinds have no angle defect and unroll without stretch") {
  for (const std::string& kind : kDevelopable) {
    for (Index triangles : {32, 1000, 57000}) {
      CAPTURE(kind);
      CAPTURE(triangles);
      const Sample sample = sample_of(kind, triangles);
      const Mesh& mesh = sample.mesh;
      const Topology topology = topology_of(mesh);
      REQUIRE(sample.flat.size() == mesh.position.size());
      std::vector<double> defect(mesh.num_vertices(), 2 * kPi);
      double largest_defect = 0, largest_stretch = 0, smallest_area = kInfinity, bend = 1;
      for (Index c = 0; c < static_cast<Index>(mesh.corner_vertex.size()); ++c) {
        defect[mesh.corner_vertex[c]] -= corner_angle(mesh, c);
        const Index v = mesh.corner_vertex[c], w = mesh.corner_vertex[next_corner(c)];
        const double length = norm(mesh.position[w] - mesh.position[v]);
        largest_stretch =
            std::max(largest_stretch, std::abs(norm(sample.flat[w] - sample.flat[v]) / length - 1));
      }
      for (Index v = 0; v < mesh.num_vertices(); ++v) {
        if (!topology.on_border[v]) largest_defect = std::max(largest_defect, std::abs(defect[v]));
      }
      const Vec3 first_normal = doubled_area_normal(mesh, 0);
      for (Index t = 0; t < mesh.num_triangles(); ++t) {
        const Vec2 a = sample.flat[mesh.corner_vertex[3 * t]];
        smallest_area = std::min(smallest_area, cross(sample.flat[mesh.corner_vertex[3 * t + 1]] - a,
                                                      sample.flat[mesh.corner_vertex[3 * t + 2]] - a));
        const Vec3 n = doubled_area_normal(mesh, t);
        bend = std::min(bend, dot(n, first_normal) / norm(n) / norm(first_normal));
      }
      CHECK(largest_defect < 1e-12);
      CHECK(largest_stretch < 1e-12);
      CHECK(smallest_area > 0);
      CHECK(bend < 0.9);  // it is a bent sheet
    }
  }
}

TEST_CASE("sample: other kinds, and noisy sheets, are not developable") {
  CHECK(sample_of("hood", 1000).flat.empty());
  const Sample noisy = sample_of("cylinder", 1000, 1e-3);
  double largest = 0;
  for (const Vec3& p : noisy.mesh.position) largest = std::max(largest, std::abs(std::hypot(p.x, p.y) - 0.5));
  CHECK(largest > 0.9e-3);
  CHECK(largest <= 1e-3 + 1e-12);
}

TEST_CASE("sample: areas tend to the closed forms") {
  const auto relative = [](const std::string& kind, double area) {
    return std::abs(area_of(sample_of(kind, 57000).mesh) / area - 1);
  };
  CHECK(relative("cylinder", 0.5 * 2.0 * 0.9) < 1e-4);
  CHECK(relative("cone", 2.4 * std::sin(0.45) * (1.5 * 1.5 - 0.6 * 0.6) / 2) < 1e-4);
  CHECK(relative("tangent-developable", 1.1 * (1.3 * 1.3 - 0.5 * 0.5) / 2) < 1e-4);
  CHECK(relative("sphere-cap", 2 * kPi * 0.25 * (1 - std::cos(0.9))) < 5e-4);
  CHECK(relative("annulus", kPi * (1 - 0.16)) < 5e-4);
}

TEST_CASE("sample: the same seed gives the same bits on any number of threads, another seed another mesh") {
  for (const std::string& kind : sample_kinds()) {
    CAPTURE(kind);
    const Sample one = sample_of(kind, 20000, 1e-4, 7, 1);
    CHECK(same_bits(one, sample_of(kind, 20000, 1e-4, 7, 1)));
    CHECK(same_bits(one, sample_of(kind, 20000, 1e-4, 7, 3)));
    CHECK_FALSE(same_bits(one, sample_of(kind, 20000, 1e-4, 8, 1)));
  }
}

TEST_CASE("sample: noise moves vertices along the normal by its amplitude and leaves the triangles") {
  const Sample smooth = sample_of("hood", 3000), noisy = sample_of("hood", 3000, 2e-3);
  CHECK(smooth.mesh.corner_vertex == noisy.mesh.corner_vertex);
  double largest = 0, sum = 0;
  for (Index v = 0; v < smooth.mesh.num_vertices(); ++v) {
    const Vec3 step = noisy.mesh.position[v] - smooth.mesh.position[v];
    largest = std::max(largest, norm(step));
    sum += step.z;
  }
  CHECK(largest <= 2e-3 * (1 + 1e-12));
  CHECK(largest > 1.9e-3);
  CHECK(std::abs(sum / smooth.mesh.num_vertices()) < 1e-4);
}

TEST_CASE("sample: features lie on the mesh, within their bound") {
  for (const std::string& kind : sample_kinds()) {
    for (Index triangles : {32, 2000}) {
      CAPTURE(kind);
      CAPTURE(triangles);
      const Sample sample = sample_of(kind, triangles, 1e-3);
      const Mesh& mesh = sample.mesh;
      REQUIRE(!sample.features.empty());
      for (const SampleFeature& feature : sample.features) {
        CAPTURE(feature.name);
        REQUIRE(feature.points.size() >= 2);
        double farthest = 0;
        for (const Vec3& p : feature.points) {
          double nearest = kInfinity;
          for (Index t = 0; t < mesh.num_triangles(); ++t) {
            nearest = std::min(nearest, distance_to_triangle(p, corner_position(mesh, 3 * t),
                                                             corner_position(mesh, 3 * t + 1),
                                                             corner_position(mesh, 3 * t + 2)));
          }
          farthest = std::max(farthest, nearest);
        }
        CHECK(farthest <= feature.max_distance);
      }
    }
  }
}

TEST_CASE(
    "sample: constraints name existing features, and the angle of two rulings is that of the unrolled "
    "sheet") {
  for (const std::string& kind : sample_kinds()) {
    const Sample sample = sample_of(kind, 1000);
    for (const SampleConstraint& constraint : sample.constraints) {
      for (const std::string& name : constraint.features) {
        CHECK(std::any_of(sample.features.begin(), sample.features.end(),
                          [&](const SampleFeature& f) { return f.name == name; }));
      }
    }
  }
  // Half of the cone's flat sweep lies between the rulings at a quarter and at three quarters.
  const Sample cone = sample_of("cone", 57000);
  CHECK(*cone.constraints.back().degrees ==
        doctest::Approx(0.5 * 2.4 * std::sin(0.45) * 180 / kPi).epsilon(0.02));
}

TEST_CASE("sample: bad options are named") {
  const Exec exec(1);
  const auto code = [&](const SampleOptions& options) {
    const auto sample = make_sample(exec, options);
    REQUIRE_FALSE(sample.has_value());
    return sample.error().code;
  };
  CHECK(code({.kind = "boat"}) == ErrorCode::BadUsage);
  CHECK(code({.kind = "hood", .triangles = 31}) == ErrorCode::BadUsage);
  CHECK(code({.kind = "hood", .noise = -1e-3}) == ErrorCode::BadUsage);
  CHECK(code({.kind = "hood", .noise = std::nan("")}) == ErrorCode::BadUsage);
}
