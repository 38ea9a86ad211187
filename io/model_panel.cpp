#include "io/model_panel.hpp"

#include <algorithm>
#include <cmath>

#include "io/feature_labels.hpp"
#include "io/feature_lines.hpp"
#include "io/flat_features.hpp"
#include "io/shaded_surface.hpp"

namespace planish {
namespace {

/// Sizes at a picture of 1600 pixels.
constexpr double kHiddenWidth = 2.6, kDash = 7, kDashGap = 7;

Result<void> check_indices(const Surface& surface, In<PlacedFeature> features) {
  const auto out_of = [](Index limit) { return [limit](Index i) { return i < 0 || i >= limit; }; };
  if (std::ranges::any_of(surface.corner_vertex, out_of(surface.num_vertices()))) {
    return fail(ErrorCode::IndexOutOfRange, "a triangle names a vertex that does not exist");
  }
  return check_features(features, surface.num_vertices(), surface.num_triangles());
}

/// Vertices that are drawn must be finite; others may be anything.
Result<void> check_positions(const Surface& surface, In<PlacedFeature> features) {
  std::vector<std::uint8_t> used(surface.position.size(), 0);
  for (const Index v : surface.corner_vertex) used[v] = 1;
  for (const PlacedFeature& feature : features) {
    for (const Index v : feature.vertex) used[v] = 1;
  }
  Error error{.code = ErrorCode::NonFinitePosition,
              .what = "a position is not finite",
              .element = ElementKind::Vertex};
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    const Vec3 p = surface.position[v];
    if (used[v] == 0 || (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) continue;
    if (error.ids.size() < kMaxListedIds) error.ids.push_back(v);
    ++error.count;
  }
  if (error.count > 0) return fail(std::move(error));
  return {};
}

std::vector<Index> tint_of_triangles(In<PlacedFeature> features, Index num_triangles) {
  std::vector<Index> tint;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].is_region()) continue;
    tint.resize(num_triangles, kNone);
    for (const Index t : features[i].triangle) tint[t] = static_cast<Index>(i);
  }
  return tint;
}

/// A feature on the page: its runs (chains) and where its name may stand, the best places first.
struct DrawnFeature {
  std::vector<LineRun> runs;
  std::vector<Vec2> anchors;
};

/// Places along the longest seen run; along the longest of all where none is seen.
std::vector<Vec2> anchors_on(const std::vector<LineRun>& runs) {
  const auto rank = [](const LineRun& run) { return std::pair(run.seen, run.point.size()); };
  const auto best = std::ranges::max_element(runs, {}, rank);
  return best == runs.end() ? std::vector<Vec2>{} : anchors_along(best->point);
}

/// The triangle nearest to the middle of those that are seen.
std::vector<Vec2> anchors_in(const PlacedFeature& region, const SeenTriangles& triangles,
                             const DepthRaster& surface) {
  std::vector<Vec2> seen;
  Vec2 sum;
  for (const Index t : region.triangle) {
    const auto corner = [&](int i) { return triangles.point[triangles.corner_vertex[3 * t + i]]; };
    const Vec3 p = (1.0 / 3) * (corner(0) + corner(1) + corner(2));
    if (!surface.sees(p, kDepthSlack)) continue;
    seen.push_back({p.x, p.y});
    sum += seen.back();
  }
  if (seen.empty()) return {};
  const Vec2 middle = (1.0 / static_cast<double>(seen.size())) * sum;
  return {*std::ranges::min_element(seen, {}, [&](Vec2 p) { return norm(p - middle); })};
}

DrawnFeature place_feature(const PlacedFeature& feature, const SeenTriangles& triangles,
                           const DepthRaster& surface, Vec2 panel_corner) {
  DrawnFeature drawn;
  if (feature.is_region()) {
    drawn.anchors = anchors_in(feature, triangles, surface);
  } else {
    drawn.runs = split_by_sight(surface, triangles.point, feature.vertex, feature.closed, kDepthSlack);
    drawn.anchors = anchors_on(drawn.runs);
  }
  for (LineRun& run : drawn.runs) {
    for (Vec2& p : run.point) p += panel_corner;
  }
  for (Vec2& p : drawn.anchors) p += panel_corner;
  return drawn;
}

/// Hidden runs first, so that no dash lies on a line that is seen.
void draw_chains(Canvas& canvas, const std::vector<DrawnFeature>& drawn, double unit) {
  for (const bool seen : {false, true}) {
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const Rgb colour = feature_colour(i);
      for (const LineRun& run : drawn[i].runs) {
        if (run.seen != seen) continue;
        if (seen) {
          draw_chain(canvas, run.point, false, colour, unit);
        } else {
          draw_dashed(canvas, run.point, unit * kDash, unit * kDashGap, {colour, unit * kHiddenWidth, 0.65});
        }
      }
    }
  }
}

void draw_names(Canvas& canvas, In<PlacedFeature> features, const std::vector<DrawnFeature>& drawn,
                const ModelPanel& panel) {
  LabelPlacer placer(panel.names);
  for (const DrawnFeature& feature : drawn) {
    for (const LineRun& run : feature.runs) placer.avoid(run.point);
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    place_name(placer, canvas, features[i].name, drawn[i].anchors, i, 1600 * panel.unit);
  }
}

std::vector<Rgb> colours_of(In<PlacedFeature> features) {
  std::vector<Rgb> colour;
  for (std::size_t i = 0; i < features.size(); ++i) colour.push_back(feature_colour(i));
  return colour;
}

}  // namespace

std::vector<Vec3> seen_from(const Exec& exec, const View& view, In<Vec3> position) {
  std::vector<Vec3> point(position.size());
  exec.for_blocks(static_cast<Index>(position.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) point[v] = view.project(position[v]);
  });
  return point;
}

SeenBox seen_box(const Surface& surface, In<Vec3> point) {
  SeenBox box;
  for (const Index v : surface.corner_vertex) {
    const Vec3 p = point[v];
    box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
    box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
  }
  if (surface.corner_vertex.empty()) box = {{}, {}};
  return box;
}

Result<void> check_model(const Surface& surface, In<PlacedFeature> features) {
  return check_indices(surface, features).and_then([&] { return check_positions(surface, features); });
}

void draw_model(const Exec& exec, Canvas& canvas, In<PlacedFeature> features, const ModelPanel& panel) {
  const std::vector<Index> tint =
      tint_of_triangles(features, static_cast<Index>(panel.corner_vertex.size() / 3));
  const std::vector<Rgb> tint_colour = colours_of(features);
  const SeenTriangles triangles{panel.corner_vertex, panel.point, tint,
                                tint_colour,         panel.width, panel.height};
  const DepthRaster surface = shade_surface(exec, triangles);
  canvas.image(draw_surface(exec, triangles, surface, panel.unit), panel.corner);
  std::vector<DrawnFeature> drawn;
  for (const PlacedFeature& feature : features) {
    drawn.push_back(place_feature(feature, triangles, surface, panel.corner));
  }
  draw_chains(canvas, drawn, panel.unit);
  draw_names(canvas, features, drawn, panel);
}

}  // namespace planish
