#include "engine/flatten.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <numeric>
#include <optional>

#include "engine/prepare/prepare.hpp"
#include "engine/solve/driver.hpp"
#include "engine/solve/gauge.hpp"
#include "engine/solve/laplacian.hpp"
#include "engine/solve/start.hpp"
#include "engine/verify/certificate.hpp"
#include "engine/verify/overlaps.hpp"
#include "kernels/intrinsic/cotangents.hpp"
#include "kernels/intrinsic/curvature.hpp"

namespace planish {
namespace {

/// Rest geometry in the units of the ordered mesh.
struct Geometry {
  std::vector<RestFrame> frame;         // [T]
  std::vector<double> cotangent;        // [3 T]
  std::vector<double> angle_sum;        // [V]
  std::vector<std::uint8_t> mollified;  // [T]
  double area = 0;
};

Geometry measure_geometry(const Exec& exec, const PreparedMesh& prepared) {
  const OrderedMesh& mesh = prepared.mesh;
  const Index num_triangles = mesh.num_triangles();
  Geometry geometry;
  geometry.frame.resize(num_triangles);
  geometry.cotangent.resize(mesh.corner_vertex.size());
  geometry.mollified.resize(num_triangles);
  std::vector<double> angle(mesh.corner_vertex.size());
  geometry.area = exec.sum_blocks(num_triangles, kBlock, [&](Range r) {
    rest_frames(r, mesh.position, mesh.corner_vertex, geometry.frame);
    cotangents(r, geometry.frame, geometry.cotangent, geometry.mollified);
    corner_angles(r, geometry.frame, angle);
    double sum = 0;
    for (Index t = r.begin; t < r.end; ++t) sum += area(geometry.frame[t]);
    return sum;
  });
  geometry.angle_sum.resize(mesh.num_vertices());
  exec.for_blocks(mesh.num_vertices(), kBlock, [&](Index, Range r) {
    angle_sums(r, angle, prepared.topology.stars(), prepared.topology.star_corner, geometry.angle_sum);
  });
  return geometry;
}

/// Component of each vertex, and the first vertex of each component.
struct VertexComponents {
  std::vector<Index> of;           // [V]
  std::vector<std::uint8_t> held;  // [V] 1 for one vertex a component
};

VertexComponents vertex_components(const Topology& topology, Index num_vertices) {
  VertexComponents result{std::vector<Index>(num_vertices), std::vector<std::uint8_t>(num_vertices, 0)};
  std::vector<std::uint8_t> seen(topology.num_components, 0);
  for (Index v = 0; v < num_vertices; ++v) {
    const Index k = result.of[v] =
        topology.triangle_component[topology.star_corner[topology.star_begin[v]] / 3];
    if (!seen[k]) result.held[v] = seen[k] = 1;
  }
  return result;
}

/// One run of flatten: its steps in order, their times, and the wish to stop between them.
class Run {
 public:
  Run(const Surface& surface, const FlattenOptions& options, const Monitor& monitor)
      : surface_(surface), options_(options), monitor_(monitor), exec_(options.threads) {}

  Result<Flattening> operator()() {
    result_.threads = exec_.threads();
    return check()
        .and_then([&] { return order(); })
        .and_then([&] { return start(); })
        .and_then([&] { return minimise(); })
        .and_then([&] { return place(); })
        .map([&] { return std::move(result_); });
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Announces a step and times it.
  template <class Step>
  Result<void> timed(Phase phase, Step step) {
    if (monitor_ && monitor_({.phase = phase}) == Verdict::Stop) {
      return fail(ErrorCode::Cancelled, "stopped by the caller");
    }
    const auto begin = Clock::now();
    Result<void> done = step();
    result_.timings.push_back({name(phase), std::chrono::duration<double>(Clock::now() - begin).count()});
    return done;
  }

  Result<void> check() {
    return timed(Phase::Check, [&]() -> Result<void> {
      auto prepared = prepare(exec_, surface_);
      if (!prepared) return fail(prepared.error());
      if (!prepared->diagnosis.usable()) return fail(refusal(prepared->diagnosis));
      prepared_ = std::move(*prepared);
      geometry_ = measure_geometry(exec_, prepared_);
      components_ = vertex_components(prepared_.topology, mesh().num_vertices());
      const Diagnosis& diagnosis = prepared_.diagnosis;
      result_.mesh = {.vertices = diagnosis.vertices,
                      .unreferenced_vertices = diagnosis.unreferenced_vertices,
                      .duplicate_positions = diagnosis.duplicate_positions,
                      .triangles = diagnosis.triangles,
                      .components = diagnosis.components,
                      .boundary_loops = diagnosis.boundary_loops,
                      .euler = diagnosis.euler,
                      .outer = {},
                      .mollified_triangles = static_cast<Index>(
                          std::count(geometry_.mollified.begin(), geometry_.mollified.end(), 1))};
      return {};
    });
  }

  Result<void> order() {
    return timed(Phase::Order, [&]() -> Result<void> {
      laplacian_ = vertex_laplacian(exec_, mesh().corner_vertex, prepared_.topology, components_.held,
                                    [&](Index c) { return cotangent_weight(c); });
      auto order = fill_reducing_order(laplacian_);
      if (!order) return fail(order.error());
      order_ = std::move(*order);
      return {};
    });
  }

  /// The rotation problem and the factorization for the positions depend on the order alone: both at once.
  Result<void> start() {
    return timed(Phase::Start, [&]() -> Result<void> {
      Result<Start> rotations = fail({});
      Result<GlobalPhase> global = fail({});
      exec_.both(
          [&] {
            rotations = first_rotations(exec_,
                                        {.corner_vertex = mesh().corner_vertex,
                                         .topology = &prepared_.topology,
                                         .frame = geometry_.frame,
                                         .cotangent = geometry_.cotangent,
                                         .angle_sum = geometry_.angle_sum,
                                         .order = order_},
                                        options_.init);
          },
          [&] { global = GlobalPhase::factor(laplacian_, order_); });
      if (!rotations) return fail(rotations.error());
      if (!global) return fail(global.error());
      rotation_ = std::move(rotations->rotation);
      result_.mesh.outer = std::move(rotations->outer_loop);
      result_.holonomy_residual = rotations->holonomy_residual;
      global_.emplace(std::move(*global));
      laplacian_ = {};
      return {};
    });
  }

  Result<void> minimise() {
    return timed(Phase::LocalGlobal, [&]() -> Result<void> {
      const ArapProblem problem{.energy = {.corner_vertex = mesh().corner_vertex,
                                           .stars = prepared_.topology.stars(),
                                           .star_corner = prepared_.topology.star_corner,
                                           .frame = geometry_.frame,
                                           .cotangent = geometry_.cotangent,
                                           .fixed = components_.held,
                                           .area = geometry_.area},
                                .global = &*global_,
                                .rotation = rotation_,
                                .order = order_,
                                .vertex_component = components_.of,
                                .num_components = prepared_.topology.num_components};
      auto minimum = minimise_arap(exec_, problem, options_, monitor_);
      if (!minimum) return fail(minimum.error());
      global_.reset();
      uv_ = std::move(minimum->uv);
      result_.history = std::move(minimum->history);
      result_.iterations = result_.history.back().iteration;
      result_.converged = minimum->converged;
      result_.gradient = minimum->gradient;
      return {};
    });
  }

  /// Gauge, layout, units; then everything is measured on the final coordinates.
  Result<void> place() {
    return timed(Phase::Measure, [&]() -> Result<void> {
      for (Vec2& z : uv_) z = mesh().unit * z;
      centre_and_align(mesh().corner_vertex, components_.of, prepared_.topology.num_components,
                       mesh().vertex_origin, uv_);
      if (prepared_.topology.num_components > 1)
        lay_out(components_.of, prepared_.topology.num_components, uv_);
      if (options_.normalize) fit_into_unit_square();
      measure();
      result_.uv.assign(mesh().num_input_vertices, {});
      for (Index v = 0; v < mesh().num_vertices(); ++v) result_.uv[mesh().vertex_origin[v]] = uv_[v];
      return {};
    });
  }

  void fit_into_unit_square() {
    Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
    for (const Vec2 z : uv_) {
      lower = {std::min(lower.x, z.x), std::min(lower.y, z.y)};
      upper = {std::max(upper.x, z.x), std::max(upper.y, z.y)};
    }
    const double scale = 1 / std::max(upper.x - lower.x, upper.y - lower.y);
    for (Vec2& z : uv_) z = scale * (z - lower);
  }

  void measure() {
    for (RestFrame& f : geometry_.frame) {
      f = {mesh().unit * f.x1, mesh().unit * f.x2, mesh().unit * f.y2};
    }
    Certificate& certificate = result_.certificate;
    certificate = certify(exec_, mesh().surface(), prepared_.topology, geometry_.frame, uv_);
    to_input_ids(certificate.flipped, mesh().triangle_origin);
    to_input_ids(certificate.overwound, mesh().vertex_origin);
    const Overlaps overlaps = find_overlaps(exec_, mesh().corner_vertex, uv_);
    certificate.overlapping_pairs = overlaps.pairs;
    certificate.overlap_area_fraction = overlaps.map_area > 0 ? overlaps.common_area / overlaps.map_area : 0;
  }

  static void to_input_ids(std::vector<Index>& ids, In<Index> origin) {
    for (Index& id : ids) id = origin[id];
    std::sort(ids.begin(), ids.end());
  }

  double cotangent_weight(Index c) const {
    const Index twin = prepared_.topology.corner_twin[c];
    return 0.5 * (geometry_.cotangent[previous_corner(c)] +
                  (twin == kNone ? 0 : geometry_.cotangent[previous_corner(twin)]));
  }

  const OrderedMesh& mesh() const { return prepared_.mesh; }

  const Surface surface_;
  const FlattenOptions options_;
  const Monitor& monitor_;
  Exec exec_;
  PreparedMesh prepared_;
  Geometry geometry_;
  VertexComponents components_;
  SymmetricMatrix laplacian_;
  std::vector<Index> order_;
  std::vector<Vec2> rotation_;
  std::optional<GlobalPhase> global_;
  std::vector<Vec2> uv_;  // [V] of the ordered mesh
  Flattening result_;
};

}  // namespace

Result<Flattening> flatten(const Surface& surface, const FlattenOptions& options, const Monitor& monitor) {
  if (!(options.tolerance > 0)) return fail(ErrorCode::BadUsage, "tolerance must be above 0");
  if (options.max_iterations < 0) return fail(ErrorCode::BadUsage, "max_iterations must not be negative");
  if (options.threads < 0) return fail(ErrorCode::BadUsage, "threads must not be negative");
  try {
    return Run(surface, options, monitor)();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory,
                "not enough memory to flatten " + std::to_string(surface.num_triangles()) + " triangles");
  }
}

}  // namespace planish
