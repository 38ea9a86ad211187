#include "io/shaded_surface.hpp"

#include <algorithm>
#include <cmath>

#include "io/feature_lines.hpp"
#include "io/outline.hpp"
#include "io/page.hpp"
#include "io/wireframe.hpp"

namespace planish {
namespace {

constexpr double kBoundaryWidth = 1.6;  // at a picture of 1600 pixels
constexpr Fading kFading{.closest = 5, .full = 20, .alpha = 0.3};

Vec2 flat(Vec3 p) { return {p.x, p.y}; }

/// Greys of the vertices, in [0, 1] before contrast.
///   point [V] pixels, y down
std::vector<float> shade(const Exec& exec, In<Index> corner_vertex, In<Vec3> point) {
  std::vector<Vec3> normal(point.size());
  for (std::size_t c = 0; c < corner_vertex.size(); c += 3) {
    const Vec3 a = point[corner_vertex[c]], b = point[corner_vertex[c + 1]], d = point[corner_vertex[c + 2]];
    const Vec3 n = cross(b - a, d - a);
    for (int i = 0; i < 3; ++i) normal[corner_vertex[c + i]] = normal[corner_vertex[c + i]] + n;
  }
  const Vec3 light = (1 / norm(Vec3{-0.45, -0.55, 0.7})) * Vec3{-0.45, -0.55, 0.7};
  std::vector<float> grey(point.size());
  exec.for_blocks(static_cast<Index>(point.size()), kBlock, [&](Index, Range r) {
    for (Index v = r.begin; v < r.end; ++v) {
      const double size = normal[v].z < 0 ? -norm(normal[v]) : norm(normal[v]);
      grey[v] = size != 0 ? static_cast<float>(0.5 + 0.5 * dot(normal[v], light) / size) : 0.5f;
    }
  });
  return grey;
}

/// Spreads the greys of a nearly flat surface, so that its shape shows; light grey is their middle.
void add_contrast(std::vector<float>& grey, In<Index> corner_vertex) {
  constexpr float kMiddle = 0.84f, kDarkest = 0.42f, kBrightest = 0.97f;
  constexpr float kSpread = 0.26f, kLeastGain = 0.6f, kMostGain = 6;
  constexpr std::size_t kMostLooks = 100000;
  std::vector<float> sorted;
  const std::size_t stride = std::max<std::size_t>(1, corner_vertex.size() / kMostLooks);
  for (std::size_t c = 0; c < corner_vertex.size(); c += stride) sorted.push_back(grey[corner_vertex[c]]);
  if (sorted.empty()) return;
  std::ranges::sort(sorted);
  const auto percentile = [&](std::size_t p) { return sorted[p * (sorted.size() - 1) / 100]; };
  const float middle = percentile(50), spread = percentile(95) - percentile(5);
  const float gain = std::clamp(kSpread / std::max(spread, 1e-6f), kLeastGain, kMostGain);
  for (float& g : grey) g = std::clamp(kMiddle + gain * (g - middle), kDarkest, kBrightest);
}

/// Inner edges that are seen from end to end.
Wireframe seen_wireframe(const Outline& outline, const SeenTriangles& triangles, const DepthRaster& surface) {
  const In<Index> corner_vertex = triangles.corner_vertex;
  const auto corner = [&](Index c) { return triangles.point[corner_vertex[c]]; };
  const auto spacing = [&](Index t) {
    return line_spacing(flat(corner(3 * t)), flat(corner(3 * t + 1)), flat(corner(3 * t + 2)));
  };
  const auto is_seen = [&](Vec3 p) { return surface.sees(p, kDepthSlack); };
  Wireframe wireframe(kFading);
  for (const Index c : outline.inner) {
    const Vec3 a = corner(c), b = corner(next_corner(c));
    if (!wireframe.shows(norm(flat(b) - flat(a))))
      continue;  // spacing is less; most of a dense mesh ends here
    const Index twin = outline.twin[c];
    const double own = spacing(c / 3);
    const double closest = twin == kNone ? own : std::min(own, spacing(twin / 3));
    if (!wireframe.shows(closest)) continue;
    if (is_seen(a) && is_seen(0.5 * (a + b)) && is_seen(b)) wireframe.add(flat(a), flat(b), closest);
  }
  return wireframe;
}

void draw_boundary(Canvas& layer, const Outline& outline, In<Vec3> point, const DepthRaster& surface,
                   double unit) {
  for (const auto& chain : outline.boundary) {
    for (const LineRun& run : split_by_sight(surface, point, chain, false, kDepthSlack)) {
      if (run.seen) layer.polyline(run.point, false, {kInk, std::max(0.6, unit * kBoundaryWidth), 0.8});
    }
  }
}

}  // namespace

DepthRaster shade_surface(const Exec& exec, const SeenTriangles& triangles) {
  std::vector<float> grey = shade(exec, triangles.corner_vertex, triangles.point);
  add_contrast(grey, triangles.corner_vertex);
  return rasterise_depth(
      exec, {triangles.corner_vertex, triangles.point, grey, triangles.tint, triangles.tint_colour},
      triangles.width, triangles.height);
}

Canvas draw_surface(const Exec& exec, const SeenTriangles& triangles, const DepthRaster& surface,
                    double unit) {
  Canvas layer(Canvas::Format::Png, triangles.width, triangles.height);
  layer.image(surface.raster, {});
  const auto num_vertices = static_cast<Index>(triangles.point.size());
  const Outline outline = find_outline(exec, triangles.corner_vertex, num_vertices);
  seen_wireframe(outline, triangles, surface).draw(layer);
  draw_boundary(layer, outline, triangles.point, surface, unit);
  return layer;
}

}  // namespace planish
