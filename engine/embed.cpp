#include "engine/embed.hpp"

#include <algorithm>
#include <new>
#include <optional>

#include "engine/features/curve.hpp"
#include "engine/features/directions.hpp"
#include "engine/features/enclosed.hpp"
#include "engine/features/feasibility.hpp"
#include "engine/features/feature_error.hpp"
#include "engine/features/one_ring.hpp"
#include "engine/features/plane_cut.hpp"
#include "engine/features/project.hpp"
#include "engine/features/references.hpp"
#include "engine/features/regions.hpp"
#include "engine/features/select.hpp"
#include "engine/features/sharp_edges.hpp"
#include "engine/prepare/prepare.hpp"

namespace planish {
namespace {

class Embedder {
 public:
  Embedder(const Surface& surface, const ConstraintSet& set, const EmbedOptions& options,
           const Monitor& monitor)
      : surface_(surface), set_(set), monitor_(monitor), exec_(options.threads) {}

  Result<Embedding> operator()() {
    return start()
        .and_then([&] { return each_feature([&](std::size_t k) { return select(k); }); })
        .and_then([&] { return project_polylines(); })
        .and_then([&] { return each_feature([&](std::size_t k) { return trace(k); }); })
        .and_then([&] { return finish(); })
        .map([&] { return std::move(result_); });
  }

 private:
  Result<void> go_on(Phase phase) const {
    const bool stop = monitor_ && monitor_({.phase = phase}) == Verdict::Stop;
    return stop ? fail(ErrorCode::Cancelled, "stopped by the caller") : Result<void>();
  }

  template <class Step>
  Result<void> each_feature(Step step) {
    for (std::size_t k = 0; k < set_.features.size(); ++k) {
      if (auto done = go_on(Phase::Embed).and_then([&] { return step(k); }); !done) return done;
    }
    return {};
  }

  Result<void> start() {
    if (auto going = go_on(Phase::Check); !going) return going;
    auto topology = manifold_topology(exec_, surface_);
    if (!topology) return fail(topology.error());
    topology_ = std::move(*topology);
    if (auto known = check_references(surface_, topology_, set_); !known) return known;
    mesh_.emplace(surface_, topology_);
    result_.features.resize(set_.features.size());
    for (std::size_t k = 0; k < set_.features.size(); ++k) result_.features[k].name = set_.features[k].name;
    return {};
  }

  // ---- features that are edges or triangles of the input ----

  template <class Source>
  const Source* source(std::size_t k) const {
    return std::get_if<Source>(&set_.features[k].source);
  }

  Result<void> take(std::size_t k, Result<std::vector<Index>> chain, bool closed) {
    if (!chain) return fail(chain.error());
    result_.features[k].vertex = std::move(*chain);
    result_.features[k].closed = closed;
    constrain(result_.features[k]);
    return {};
  }

  Result<void> select(std::size_t k) {
    const std::string& name = set_.features[k].name;
    if (const auto* s = source<VertexSource>(k)) {
      return take(k, chain_of_vertices(surface_, topology_, name, *s), s->closed);
    }
    if (const auto* s = source<LoopSource>(k))
      return take(k, chain_of_loop(surface_, topology_, name, *s), true);
    if (const auto* s = source<BoundaryNearSource>(k)) {
      return take(k, chain_of_nearest_loop(surface_, topology_, name, *s), true);
    }
    if (const auto* s = source<SharpEdgesSource>(k)) {
      auto found = chain_of_sharp_edges(exec_, surface_, topology_, name, *s);
      if (!found) return fail(found.error());
      return take(k, std::move(found->vertex), found->closed);
    }
    if (const auto* s = source<TriangleSource>(k)) {
      auto region = region_of_triangles(surface_, topology_, name, *s);
      if (!region) return fail(region.error());
      result_.features[k].triangle = std::move(*region);
    }
    return {};
  }

  void constrain(const Feature& chain) {
    for_each_edge(chain, [&](Index u, Index v) { mesh_->constrain(mesh_->edge_between(u, v)); });
  }

  // ---- curves ----

  Result<void> project_polylines() {
    std::size_t num_polylines = 0, num_points = 0;
    for (const FeatureSpec& spec : set_.features) {
      const auto* polyline = std::get_if<PolylineSource>(&spec.source);
      if (polyline == nullptr) continue;
      ++num_polylines;
      num_points += polyline->point.size();
    }
    if (num_polylines == 0) return {};
    constexpr std::size_t kFew = 4;  // times as many triangles as points
    const bool few = kFew * num_points < static_cast<std::size_t>(surface_.num_triangles());
    const SurfaceLocator locator(exec_, surface_,
                                 few ? SurfaceLocator::Built::ForFewQueries : SurfaceLocator::Built::ForMany);
    auto projected = project(exec_, surface_, topology_, locator, set_.features);
    if (!projected) return fail(projected.error());
    projection_ = std::move(*projected);
    return {};
  }

  Result<void> trace(std::size_t k) {
    const std::string& name = set_.features[k].name;
    if (const auto* s = source<PolylineSource>(k)) {
      return embed(k, {.name = name,
                       .at = projection_[k].at,
                       .given = s->point,
                       .closed = s->closed,
                       .allowed = allowed_distance(*s)});
    }
    if (const auto* s = source<PlaneCutSource>(k)) {
      const auto curve = plane_cut(exec_, surface_, topology_, name, *s);
      if (!curve) return fail(curve.error());
      return embed(k, {.name = name,
                       .at = curve->at,
                       .given = curve->position,
                       .closed = curve->closed,
                       .allowed = allowed_distance({curve->position, curve->closed, {}})});
    }
    return {};
  }

  Result<void> embed(std::size_t k, const CurveOnSurface& curve) {
    auto embedded = embed_curve(*mesh_, surface_, curve);
    if (!embedded) return fail(embedded.error());
    Feature& feature = result_.features[k];
    feature.vertex = std::move(embedded->vertex);
    feature.closed = curve.closed;
    feature.max_deviation = embedded->deviation;
    result_.snapped_points += embedded->snapped;
    return {};
  }

  // ---- the finished mesh ----

  Result<void> finish() {
    if (auto going = go_on(Phase::Embed); !going) return going;
    mesh_->improve();
    for (Feature& feature : result_.features) follow_splits(feature);
    turn_free_chains();
    if (auto directed = check_directions(result_.features); !directed) return directed;
    free_triangles();
    for (Index v = surface_.num_vertices(); v < mesh_->num_vertices(); ++v) {
      result_.vertex_origin.push_back(mesh_->origin(v));
    }
    result_.position = mesh_->take_position();
    result_.corner_vertex = mesh_->take_corner_vertex();
    result_.triangle_origin = mesh_->take_triangle_origin();
    mesh_.reset();
    for (Feature& feature : result_.features) measure(feature);
    return find_regions();
  }

  /// Edges of a chain may have been split by later chains.
  void follow_splits(Feature& feature) const {
    if (feature.vertex.empty()) return;
    std::vector<Index> chain = {feature.vertex.front()};
    for_each_edge(feature, [&](Index u, Index v) { mesh_->follow(u, v, chain); });
    if (feature.closed) chain.pop_back();
    feature.vertex = std::move(chain);
  }

  void turn_free_chains() {
    std::vector<std::uint8_t> turnable;
    for (std::size_t k = 0; k < set_.features.size(); ++k) {
      turnable.push_back(source<LoopSource>(k) || source<BoundaryNearSource>(k) ||
                         source<PlaneCutSource>(k) || source<SharpEdgesSource>(k));
    }
    if (std::find(turnable.begin(), turnable.end(), 1) != turnable.end())
      turn_chains(result_.features, turnable);
  }

  void free_triangles() {
    std::vector<PrescribedChain> chains;
    const auto add = [&](const std::string& name, bool straight) {
      for (const Feature& feature : result_.features) {
        if (feature.name == name && !feature.vertex.empty()) chains.push_back({feature.vertex, straight});
      }
    };
    for (const Constraint& constraint : set_.constraints) {
      if (const auto* line = std::get_if<LineConstraint>(&constraint.rule)) add(line->feature, true);
      if (const auto* circle = std::get_if<CircleConstraint>(&constraint.rule)) add(circle->feature, false);
      if (const auto* curve = std::get_if<CurveConstraint>(&constraint.rule)) add(curve->feature, false);
    }
    if (!chains.empty()) result_.feasibility_splits = free_prescribed_triangles(*mesh_, chains);
  }

  void measure(Feature& feature) const {
    for_each_edge(feature, [&](Index u, Index v) {
      feature.length += norm(result_.position[v] - result_.position[u]);
    });
  }

  Result<void> find_regions() {
    Topology topology;
    for (std::size_t k = 0; k < set_.features.size(); ++k) {
      if (source<TriangleSource>(k)) refine_region(result_.features[k]);
      const auto* s = source<EnclosedBySource>(k);
      if (!s) continue;
      if (topology.star_begin.empty()) topology = build_topology(exec_, result_.surface());
      const auto chain = std::find_if(result_.features.begin(), result_.features.end(),
                                      [&](const Feature& f) { return f.name == s->feature; });
      if (chain == result_.features.end() || chain->vertex.empty()) {
        return fail(feature_error(ErrorCode::RegionBroken, set_.features[k].name,
                                  "\"" + s->feature + "\", which encloses it, is no chain"));
      }
      auto triangles = enclosed_triangles(result_.surface(), topology, set_.features[k].name, chain->vertex,
                                          chain->closed, *s);
      if (!triangles) return fail(triangles.error());
      result_.features[k].triangle = std::move(*triangles);
    }
    return {};
  }

  /// From triangles of the input to the pieces they were cut into.
  void refine_region(Feature& feature) const {
    std::vector<std::uint8_t> chosen(surface_.num_triangles(), 0);
    for (const Index t : feature.triangle) chosen[t] = 1;
    feature.triangle.clear();
    for (std::size_t t = 0; t < result_.triangle_origin.size(); ++t) {
      if (chosen[result_.triangle_origin[t]]) feature.triangle.push_back(static_cast<Index>(t));
    }
  }

  const Surface surface_;
  const ConstraintSet& set_;
  const Monitor& monitor_;
  Exec exec_;
  Topology topology_;
  std::optional<RefinedMesh> mesh_;
  std::vector<Projection> projection_;
  Embedding result_;
};

}  // namespace

Result<Embedding> embed(const Surface& surface, const ConstraintSet& set, const EmbedOptions& options,
                        const Monitor& monitor) {
  if (options.threads < 0) return fail(ErrorCode::BadUsage, "threads must not be negative");
  try {
    return Embedder(surface, set, options, monitor)();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "not enough memory to embed features into " +
                                            std::to_string(surface.num_triangles()) + " triangles");
  }
}

}  // namespace planish
