#include "engine/sample/panels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/sample/random.hpp"
#include "engine/sample/shapes.hpp"
#include "engine/sample/spread_features.hpp"
#include "engine/sample/triangulate.hpp"

namespace planish {
namespace {

constexpr Index kFewestTriangles = 32;
constexpr Index kMostTriangles = std::numeric_limits<Index>::max() / 3;
constexpr Index kRowBlock = 8;

struct Kind {
  const char* name;
  Shape (*shape)();
  Developable (*sheet)();
};

constexpr Kind kKinds[] = {
    {"hood", hood_shape, nullptr},
    {"fender", fender_shape, nullptr},
    {"door", door_shape, nullptr},
    {"cylinder", nullptr, cylinder_sheet},
    {"cone", nullptr, cone_sheet},
    {"tangent-developable", nullptr, tangent_sheet},
    {"sphere-cap", sphere_cap_shape, nullptr},
    {"annulus", annulus_shape, nullptr},
};

/// Offset of a vertex along its normal.
double noise_at(const SampleOptions& options, Index v) {
  return options.noise * (2 * counter_random(~options.seed, v) - 1);
}

Vec3 surface_normal(const Shape& shape, Vec2 p) {
  constexpr double kStep = 1e-6;
  const Vec3 x = shape.surface({p.x + kStep, p.y}) - shape.surface({p.x - kStep, p.y});
  const Vec3 y = shape.surface({p.x, p.y + kStep}) - shape.surface({p.x, p.y - kStep});
  const Vec3 n = cross(x, y);
  return (1 / norm(n)) * n;
}

/// Features of the bent sheet, on its strips.
void spread_over_sheet(const Exec& exec, const Rulings& sheet, Index count, Sample& sample) {
  const auto strips = static_cast<Index>(sheet.ruling.size()) - 1;
  const auto chart = [&](double u, double v) {
    const Index k = std::min(static_cast<Index>(v * strips), strips - 1);
    const auto on_ruling = [&](const Rulings::Ruling& ruling) {
      return ruling.flat + (u * sheet.length) * ruling.flat_direction;
    };
    const Vec2 a = on_ruling(sheet.ruling[k]), b = on_ruling(sheet.ruling[k + 1]);
    return a + (v * strips - k) * (b - a);
  };
  spread_features(
      exec, {RowShape::Open, chart}, [&](Vec2 p) { return bent_point(sheet, p); }, count, sample);
}

/// Features need not lie closer to the mesh than its triangles lie to the surface.
void bound_distances(const SampleOptions& options, double area, Sample& sample) {
  constexpr double kPart = 0.01;  // of the length: the default of the constraint file
  const double edge = std::sqrt(2.3 * area / sample.mesh.num_triangles());
  for (SampleFeature& feature : sample.features) {
    double length = 0;
    for (std::size_t i = 1; i < feature.points.size(); ++i)
      length += norm(feature.points[i] - feature.points[i - 1]);
    feature.max_distance = std::max(kPart * length, edge + options.noise);
  }
}

double surface_area(const Exec& exec, const Mesh& mesh) {
  return exec.sum_blocks(mesh.num_triangles(), kBlock, [&](Range r) {
    double sum = 0;
    for (Index t = r.begin; t < r.end; ++t) {
      const Vec3 a = mesh.position[mesh.corner_vertex[3 * t]];
      const Vec3 b = mesh.position[mesh.corner_vertex[3 * t + 1]];
      const Vec3 c = mesh.position[mesh.corner_vertex[3 * t + 2]];
      sum += norm(cross(b - a, c - a)) / 2;
    }
    return sum;
  });
}

Sample sample_shape(const Exec& exec, const SampleOptions& options, const Shape& shape) {
  const RowPlan plan =
      plan_rows(exec, shape.domain, num_strips(shape.domain, options.triangles), options.triangles);
  RowMesh rows = triangulate_rows(exec, shape.domain, plan, options.seed);
  Sample sample;
  sample.features = shape.features;
  sample.constraints = shape.constraints;
  if (options.feature_count > 0) {
    spread_features(exec, shape.domain, shape.surface, options.feature_count, sample);
  }
  std::vector<Vec3>& position = sample.mesh.position;
  position.resize(plan.num_vertices());
  exec.for_blocks(plan.num_vertices(), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) position[v] = shape.surface(rows.chart[v]);
  });
  flip_to_larger_angles(exec, plan, rows.chart, position, rows.corner_vertex);
  sample.mesh.corner_vertex = std::move(rows.corner_vertex);
  if (options.noise > 0) {
    exec.for_blocks(plan.num_vertices(), kBlock, [&](Index, Range r) {
      for (Index v = r.begin; v < r.end; ++v) {
        position[v] = position[v] + noise_at(options, v) * surface_normal(shape, rows.chart[v]);
      }
    });
  }
  return sample;
}

Sample sample_sheet(const Exec& exec, const SampleOptions& options, const Developable& kind) {
  const Index strips = num_strips(kind.smooth, options.triangles);
  const RowPlan plan = plan_rows(exec, kind.smooth, strips, options.triangles);
  const Rulings sheet = kind.bend(strips);
  RowDomain domain = kind.smooth;
  domain.ruling = [&](double u, Index k) {
    return sheet.ruling[k].flat + (u * sheet.length) * sheet.ruling[k].flat_direction;
  };
  RowMesh rows = triangulate_rows(exec, domain, plan, options.seed);
  Sample sample;
  kind.mark(sheet, sample);
  if (options.feature_count > 0) spread_over_sheet(exec, sheet, options.feature_count, sample);
  sample.mesh.corner_vertex = std::move(rows.corner_vertex);
  sample.flat = std::move(rows.chart);
  std::vector<Vec3>& position = sample.mesh.position;
  position.resize(plan.num_vertices());
  exec.for_blocks(strips + 1, kRowBlock, [&](Index, Range r) {
    for (Index k = r.begin; k < r.end; ++k) {
      const Rulings::Ruling& ruling = sheet.ruling[k];
      for (Index v = plan.row_begin[k]; v < plan.row_begin[k + 1]; ++v) {
        const double along = dot(sample.flat[v] - ruling.flat, ruling.flat_direction);
        position[v] = ruling.bent + along * ruling.bent_direction + noise_at(options, v) * ruling.normal;
      }
    }
  });
  return sample;
}

Result<const Kind*> kind_of(const SampleOptions& options) {
  const auto* kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [&](const Kind& k) { return options.kind == k.name; });
  if (kind == std::end(kKinds)) {
    std::string known;
    for (const Kind& k : kKinds) known += (known.empty() ? "" : ", ") + std::string(k.name);
    return fail(ErrorCode::BadUsage, "no sample is called '" + options.kind + "'; there are " + known);
  }
  if (options.triangles < kFewestTriangles || options.triangles > kMostTriangles) {
    return fail(ErrorCode::BadUsage, "a sample has " + std::to_string(kFewestTriangles) + " to " +
                                         std::to_string(kMostTriangles) + " triangles, not " +
                                         std::to_string(options.triangles));
  }
  if (!(options.noise >= 0) || !std::isfinite(options.noise)) {
    return fail(ErrorCode::BadUsage, "the noise of a sample is a length of 0 or more");
  }
  if (options.feature_count < 0 || options.feature_count > kMostSpreadFeatures) {
    return fail(ErrorCode::BadUsage, "up to " + std::to_string(kMostSpreadFeatures) +
                                         " features are spread over a sample, not " +
                                         std::to_string(options.feature_count));
  }
  return kind;
}

}  // namespace

const std::vector<std::string>& sample_kinds() {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> names;
    for (const Kind& kind : kKinds) names.emplace_back(kind.name);
    return names;
  }();
  return kinds;
}

Result<Sample> make_sample(const Exec& exec, const SampleOptions& options) {
  const Result<const Kind*> kind = kind_of(options);
  if (!kind) return fail(kind.error());
  Sample sample = (*kind)->shape ? sample_shape(exec, options, (*kind)->shape())
                                 : sample_sheet(exec, options, (*kind)->sheet());
  bound_distances(options, surface_area(exec, sample.mesh), sample);
  return sample;
}

}  // namespace planish
