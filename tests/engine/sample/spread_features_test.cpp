#include "engine/sample/spread_features.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "engine/features/nearest.hpp"
#include "engine/sample/shapes.hpp"

using namespace planish;

namespace {

Sample sample_of(const std::string& kind, Index features, Index triangles = 2000, double noise = 0,
                 int threads = 1) {
  const Exec exec(threads);
  auto sample =
      make_sample(exec, {.kind = kind, .triangles = triangles, .noise = noise, .feature_count = features});
  REQUIRE(sample.has_value());
  return *std::move(sample);
}

Vec3 corner_position(const Mesh& mesh, Index c) { return mesh.position[mesh.corner_vertex[c]]; }

double distance_to_mesh(const Mesh& mesh, Vec3 p) {
  double nearest = kInfinity;
  for (Index c = 0; c < 3 * mesh.num_triangles(); c += 3) {
    nearest = std::min(nearest,
                       squared_distance_to_triangle(p, corner_position(mesh, c), corner_position(mesh, c + 1),
                                                    corner_position(mesh, c + 2)));
  }
  return std::sqrt(nearest);
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (Index c = 0; c < 3 * mesh.num_triangles(); c += 3) {
    const Vec3 a = corner_position(mesh, c);
    sum += norm(cross(corner_position(mesh, c + 1) - a, corner_position(mesh, c + 2) - a)) / 2;
  }
  return sum;
}

/// Side of a cell if all were square and alike.
double cell_size(const Sample& sample) {
  return std::sqrt(area_of(sample.mesh) / static_cast<double>(sample.features.size()));
}

using Segments = std::vector<std::pair<Vec3, Vec3>>;

Segments segments_of(const SampleFeature& feature) {
  Segments segments;
  const std::size_t n = feature.points.size();
  for (std::size_t i = 0; i + (feature.closed ? 0 : 1) < n; ++i) {
    segments.emplace_back(feature.points[i], feature.points[(i + 1) % n]);
  }
  return segments;
}

Segments border_of(const Mesh& mesh) {
  std::map<std::pair<Index, Index>, int> uses;
  for (Index c = 0; c < 3 * mesh.num_triangles(); ++c) {
    ++uses[std::minmax(mesh.corner_vertex[c], mesh.corner_vertex[next_corner(c)])];
  }
  Segments border;
  for (const auto& [edge, count] : uses) {
    if (count == 1) border.emplace_back(mesh.position[edge.first], mesh.position[edge.second]);
  }
  return border;
}

double distance_between(const std::vector<Vec3>& points, const Segments& segments) {
  double nearest = kInfinity;
  for (const Vec3& p : points) {
    for (const auto& [a, b] : segments) nearest = std::min(nearest, squared_distance_to_segment(p, a, b));
  }
  return std::sqrt(nearest);
}

/// The largest distance between two points.
double extent_of(const std::vector<Vec3>& points) {
  double largest = 0;
  for (const Vec3& p : points) {
    for (const Vec3& q : points) largest = std::max(largest, norm(p - q));
  }
  return largest;
}

}  // namespace

TEST_CASE("spread_features: so many as asked for, lines and circles in turn, each with its constraint") {
  for (const std::string& kind : sample_kinds()) {
    for (Index count : {1, 2, 7, 100, 1000}) {
      CAPTURE(kind);
      CAPTURE(count);
      const Sample sample = sample_of(kind, count);
      REQUIRE(sample.features.size() == static_cast<std::size_t>(count));
      REQUIRE(sample.constraints.size() == static_cast<std::size_t>(count));
      Index wrong = 0;
      for (Index i = 0; i < count; ++i) {
        const SampleFeature& feature = sample.features[i];
        const SampleConstraint& constraint = sample.constraints[i];
        wrong += feature.closed != (i % 2 == 1);
        wrong += constraint.type != (i % 2 == 1 ? "circle" : "line");
        wrong += constraint.features != std::vector{feature.name} || constraint.degrees;
        wrong += feature.points.size() < 12 || feature.points.size() > 40;
        wrong += !(feature.max_distance > 0);
      }
      CHECK(wrong == 0);
      CHECK(sample.features.front().name == "line_0001");
      if (count >= 2) CHECK(sample.features[1].name == "circle_0002");
      if (count == 1000) CHECK(sample.features.back().name == "circle_1000");
    }
  }
}

TEST_CASE("spread_features: features stay clear of one another and of the border") {
  for (const std::string& kind : sample_kinds()) {
    for (Index count : {1, 10, 61, 200}) {
      CAPTURE(kind);
      CAPTURE(count);
      const Sample sample = sample_of(kind, count);
      const Segments border = border_of(sample.mesh);
      double from_border = kInfinity, from_neighbour = kInfinity;
      for (Index i = 0; i < count; ++i) {
        const std::vector<Vec3>& points = sample.features[i].points;
        from_border = std::min(from_border, distance_between(points, border));
        for (Index j = 0; j < i; ++j) {
          // No feature is larger than its cell by far; distant ones need not be measured.
          if (norm(points[0] - sample.features[j].points[0]) > 3 * cell_size(sample)) continue;
          from_neighbour =
              std::min(from_neighbour, distance_between(points, segments_of(sample.features[j])));
        }
      }
      CHECK(from_border > 0.05 * cell_size(sample));
      CHECK(from_neighbour > 0.1 * cell_size(sample));
    }
  }
}

TEST_CASE("spread_features: together they fill the panel") {
  for (const std::string& kind : sample_kinds()) {
    for (Index count : {10, 100, 1000}) {
      CAPTURE(kind);
      CAPTURE(count);
      const Sample sample = sample_of(kind, count);
      double sum = 0, smallest = kInfinity, largest = 0;
      for (const SampleFeature& feature : sample.features) {
        const double size = extent_of(feature.points) / cell_size(sample);
        sum += size / count;
        smallest = std::min(smallest, size);
        largest = std::max(largest, size);
      }
      CHECK(sum > 0.35);
      CHECK(smallest > 0.15);
      CHECK(largest < 1);
    }
  }
}

TEST_CASE("spread_features: points lie on the surface, at any number of triangles and with noise") {
  for (const std::string& kind : sample_kinds()) {
    for (Index triangles : {32, 1000}) {
      CAPTURE(kind);
      CAPTURE(triangles);
      const Sample sample = sample_of(kind, 40, triangles, 1e-3);
      double excess = -kInfinity;
      for (const SampleFeature& feature : sample.features) {
        for (const Vec3& p : feature.points) {
          excess = std::max(excess, distance_to_mesh(sample.mesh, p) - feature.max_distance);
        }
      }
      CHECK(excess <= 0);
    }
  }
  const auto farthest = [](const std::string& kind, auto&& distance) {
    double largest = 0;
    const Sample sample = sample_of(kind, 100, 500);
    for (const SampleFeature& feature : sample.features) {
      for (const Vec3& p : feature.points) largest = std::max(largest, std::abs(distance(sample.mesh, p)));
    }
    return largest;
  };
  // Sheets are polyhedra: without noise the mesh is the surface.
  for (const std::string kind : {"cylinder", "cone", "tangent-developable"}) {
    CAPTURE(kind);
    CHECK(farthest(kind, distance_to_mesh) < 1e-12);
  }
  const Shape hood = hood_shape(), door = door_shape();
  CHECK(farthest("hood", [&](const Mesh&, Vec3 p) { return norm(hood.surface({p.x, p.y}) - p); }) < 1e-12);
  CHECK(farthest("door", [&](const Mesh&, Vec3 p) { return norm(door.surface({p.x, p.z}) - p); }) < 1e-12);
  CHECK(farthest("sphere-cap", [](const Mesh&, Vec3 p) { return norm(p) - 0.5; }) < 1e-12);
  CHECK(farthest("annulus", [](const Mesh&, Vec3 p) { return p.z; }) == 0);
}

TEST_CASE("spread_features: on a flat panel lines are straight and circles round") {
  const Sample annulus = sample_of("annulus", 50);
  for (const SampleFeature& feature : annulus.features) {
    Vec3 middle;
    for (const Vec3& p : feature.points)
      middle = middle + (1.0 / static_cast<double>(feature.points.size())) * p;
    const double radius = norm(feature.points[0] - middle);
    double worst = 0;
    for (const Vec3& p : feature.points) {
      worst = std::max(worst, feature.closed ? std::abs(norm(p - middle) - radius)
                                             : norm(cross(p - middle, feature.points[0] - middle)));
    }
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("spread_features: neither the mesh nor the features that a kind has by itself are touched") {
  const Sample own = sample_of("hood", 0), spread = sample_of("hood", 10);
  std::vector<std::string> names;
  for (const SampleFeature& feature : own.features) names.push_back(feature.name);
  CHECK(names == std::vector<std::string>{"crease_left", "crease_right", "centre_line", "cross_line"});
  CHECK(own.constraints.size() == 5);
  CHECK(own.mesh.position == spread.mesh.position);
  CHECK(own.mesh.corner_vertex == spread.mesh.corner_vertex);
}

TEST_CASE("spread_features: the same bits on any number of threads") {
  for (const std::string& kind : sample_kinds()) {
    CAPTURE(kind);
    const Sample one = sample_of(kind, 300), three = sample_of(kind, 300, 2000, 0, 3);
    Index different = 0;
    for (Index i = 0; i < 300; ++i) {
      different += one.features[i].points != three.features[i].points ||
                   one.features[i].max_distance != three.features[i].max_distance;
    }
    CHECK(different == 0);
  }
}

TEST_CASE("spread_features: counts out of range are named") {
  const Exec exec(1);
  for (Index count : {-1, kMostSpreadFeatures + 1}) {
    const auto sample = make_sample(exec, {.kind = "hood", .feature_count = count});
    REQUIRE_FALSE(sample.has_value());
    CHECK(sample.error().code == ErrorCode::BadUsage);
  }
}
