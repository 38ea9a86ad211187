// The first global step against the paper's multiplier form.
#include <algorithm>
#include <memory>

#include "engine/constraints/fit.hpp"
#include "engine/constraints/system.hpp"
#include "engine/prepare/geometry.hpp"
#include "engine/solve/global_phase.hpp"
#include "engine/solve/laplacian.hpp"
#include "tests/support/case_generators.hpp"
#include "tests/support/check_property.hpp"
#include "tests/support/multipliers.hpp"
#include "tests/support/random_constraints.hpp"

using namespace planish;

namespace {

/// What the first global step starts from, in the numbers and units of the input.
class FirstStep {
 public:
  /// outcome: says of templates that may lie either way round which way they do.
  FirstStep(const ConstrainedCase& c, const std::vector<ConstraintOutcome>& outcome) : c_(c) {
    prepare_mesh();
    number_features();
    const RegionMap map = [](const Surface& region) -> Result<std::vector<Vec2>> {
      auto flat = flatten(region, {.threads = 1});
      RC_ASSERT(flat.has_value());
      return flat->uv;
    };
    auto system = ConstraintSystem::make(rest_, view_, map, component_);
    RC_ASSERT(system.has_value());
    system_ = std::move(*system);
    for (Index b = 0; b < static_cast<Index>(system_->compiled().bodies.size()); ++b) {
      const Body& body = system_->compiled().bodies[b];
      if (!body.chirality_open) continue;
      for (const ConstraintOutcome& o : outcome) {
        if (o.name == c.set.constraints[body.constraint].name && o.mirrored != body.mirrored)
          RC_ASSERT(system_->mirror(b).has_value());
      }
    }
    RC_ASSERT(orient().has_value());
    turn_onto_pins();
  }

  /// The same equations, solved with multipliers.
  multipliers::Solution solve() const { return multipliers::solve(problem(*system_, true)); }
  bool pinned() const { return system_->pins().size() > 0; }
  bool directed() const { return system_->directed()[0] != 0; }

 private:
  void prepare_mesh() {
    auto prepared = prepare(exec_, c_.mesh.surface());
    RC_ASSERT(prepared.has_value());
    prepared_ = std::move(*prepared);
    geometry_ = measure_geometry(exec_, prepared_);
    component_ = vertex_components(prepared_.topology, mesh().num_vertices());
    outer_loop_ = outer_loops(prepared_.topology);
    loop_of_.assign(mesh().num_vertices(), kNone);
    for (Index l = 0; l < prepared_.topology.num_loops(); ++l) {
      for (const Index k :
           slice(In<Index>(prepared_.topology.loop_corner), prepared_.topology.loops().group(l)))
        loop_of_[mesh().corner_vertex[k]] = l;
    }
    rest_ = {&mesh(), &prepared_.topology, geometry_.frame, outer_loop_, loop_of_};
  }

  void number_features() {
    std::vector<Index> vertex(mesh().num_input_vertices), triangle(mesh().num_triangles());
    for (Index v = 0; v < mesh().num_vertices(); ++v) vertex[mesh().vertex_origin[v]] = v;
    for (Index t = 0; t < mesh().num_triangles(); ++t) triangle[mesh().triangle_origin[t]] = t;
    features_ = c_.features;
    for (Feature& feature : features_) {
      for (Index& v : feature.vertex) v = vertex[v];
      for (Index& t : feature.triangle) t = triangle[t];
      std::sort(feature.triangle.begin(), feature.triangle.end());
    }
    view_ = {&c_.set, features_, {}};
  }

  Result<void> orient() {
    const std::vector<std::uint8_t> none(mesh().num_vertices(), 0);
    auto order = fill_reducing_order(
        Exec(2), vertex_laplacian(exec_, mesh().corner_vertex, prepared_.topology, none,
                                  [&](Index k) { return geometry_.edge_weight(prepared_.topology, k); }));
    RC_ASSERT(order.has_value());
    return system_->orient(exec_,
                           {.corner_vertex = mesh().corner_vertex,
                            .topology = &prepared_.topology,
                            .frame = geometry_.frame,
                            .cotangent = geometry_.cotangent,
                            .angle_sum = geometry_.angle_sum,
                            .order = *order,
                            .outer_loop = outer_loop_},
                           Init::Uniform);
  }

  /// As several pins ask for, from the map without them.
  void turn_onto_pins() {
    if (system_->pins().size() < 2) return;
    auto unpinned = system_->without_pins();
    RC_ASSERT(unpinned.has_value());
    const std::vector<Vec2> z = multipliers::solve(problem(**unpinned, false)).z;
    std::vector<Vec2> from, to;
    for (const Pin& pin : system_->pins()) {
      from.push_back(z[mesh().vertex_origin[pin.vertex]]);
      to.push_back(mesh().unit * pin.uv);
    }
    const double by = argument(best_placement(from, to, 0).c);
    system_->turn(In<double>(&by, 1));
  }

  multipliers::Problem problem(const ConstraintSystem& system, bool with_pins) const {
    auto dof = system.dof_map(true);
    RC_ASSERT(dof.has_value());
    rotation_.resize(mesh().num_triangles());
    for (Index t = 0; t < mesh().num_triangles(); ++t)
      rotation_[mesh().triangle_origin[t]] = unit(system.theta()[t]);
    multipliers::Problem problem{.position = c_.mesh.position,
                                 .corner_vertex = c_.mesh.corner_vertex,
                                 .rotation = rotation_,
                                 .shapes = {},
                                 .pins = {}};
    std::vector<std::string> groups;
    const std::vector<Body>& bodies = system.compiled().bodies;
    for (Index b = 0; b < static_cast<Index>(bodies.size()); ++b) {
      const Body& body = bodies[b];
      multipliers::DirectedShape shape{.vertex = {},
                                       .shape = {},
                                       .direction = unit((*dof)->poses()->angle(b)),
                                       .scale = body.scale,
                                       .free_lengths = body.kind == Body::Kind::FreeLine};
      if (!body.scale_group.empty()) {
        const auto known = std::find(groups.begin(), groups.end(), body.scale_group);
        shape.scale_group = static_cast<Index>(known - groups.begin());
        if (known == groups.end()) groups.push_back(body.scale_group);
      }
      for (std::size_t i = 0; i < body.vertex.size(); ++i) {
        shape.vertex.push_back(mesh().vertex_origin[body.vertex[i]]);
        shape.shape.push_back(mesh().unit * body.shape[i]);
      }
      problem.shapes.push_back(std::move(shape));
    }
    if (with_pins) {
      for (const Pin& pin : system.pins())
        problem.pins.emplace_back(mesh().vertex_origin[pin.vertex], mesh().unit * pin.uv);
    }
    return problem;
  }

  const OrderedMesh& mesh() const { return prepared_.mesh; }

  const ConstrainedCase& c_;
  Exec exec_{1};
  PreparedMesh prepared_;
  Geometry geometry_;
  std::vector<Index> component_, outer_loop_, loop_of_;
  std::vector<Feature> features_;
  RestSurface rest_;
  ConstraintView view_;
  std::unique_ptr<ConstraintSystem> system_;
  mutable std::vector<Vec2> rotation_;
};

double extent(In<Vec2> z) {
  Vec2 lower = z[0], upper = z[0];
  for (const Vec2 p : z) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  return std::max(upper.x - lower.x, upper.y - lower.y);
}

/// Farthest point of one map from the other, moved and turned as far as nothing fixes it.
double distance(In<Vec2> a, In<Vec2> b, bool pinned, bool directed) {
  Placement placement = best_placement(a, b, 1);
  if (directed || pinned) placement.c = {1, 0};
  if (pinned) placement.p = {};
  if (directed && !pinned) {
    Vec2 sum{};
    for (std::size_t v = 0; v < a.size(); ++v) sum += b[v] - a[v];
    placement.p = (1 / static_cast<double>(a.size())) * sum;
  }
  double farthest = 0;
  for (std::size_t v = 0; v < a.size(); ++v)
    farthest = std::max(farthest, norm(placement.p + multiply(placement.c, a[v]) - b[v]));
  return farthest;
}

void agrees(const CaseSeeds& seeds) {
  const ConstrainedCase c = feasible_case(seeds);
  if (c.set.constraints.empty()) return;
  RC_LOG() << c << std::endl;
  const auto flat =
      flatten(c.mesh.surface(), c.constraints(),
              {.flips = Flips::Keep, .max_iterations = 0, .keep_directions = true, .threads = 1});
  if (!flat) RC_LOG() << describe(flat.error()) << std::endl;
  RC_ASSERT(flat.has_value());
  const FirstStep first(c, flat->constraints.outcome);
  const multipliers::Solution expected = first.solve();
  const double size = extent(expected.z);
  RC_LOG() << expected.equations << " equations, " << expected.redundant << " redundant, off by "
           << expected.contradiction << std::endl;
  RC_ASSERT(expected.contradiction <= 1e-9 * size);
  const double off = distance(expected.z, flat->uv, first.pinned(), first.directed());
  RC_LOG() << "maps differ by " << off / size << " of their extent" << std::endl;
  RC_ASSERT(off <= 1e-8 * size);
}

}  // namespace

TEST_CASE("constraints: the first step is the minimum that multipliers find") {
  check_property(300, [] { agrees(*case_seeds(200, 450, 9)); });
}

TEST_CASE("constraints: the first step is the minimum that multipliers find, on larger meshes") {
  check_property(4, [] { agrees(*case_seeds(1500, 2000, 12)); });
}
