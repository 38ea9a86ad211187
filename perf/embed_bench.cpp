// Times embed(): polylines of many segments into a scan-like panel, after proving that the surface keeps its area.
//
// usage: embed_bench [--triangles N] [--polylines N] [--segments N] [--runs N] [--threads N]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "engine/embed.hpp"
#include "engine/features/surface_locator.hpp"
#include "engine/sample/panels.hpp"

namespace {

using namespace planish;

struct Options {
  Index triangles = 1'000'000, polylines = 1000, segments = 100, runs = 5, threads = 0;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view word = argv[i];
    Index* value = word == "--triangles"   ? &options.triangles
                   : word == "--polylines" ? &options.polylines
                   : word == "--segments"  ? &options.segments
                   : word == "--runs"      ? &options.runs
                   : word == "--threads"   ? &options.threads
                                           : nullptr;
    if (!value) {
      fmt::print(stderr, "embed_bench: unknown option {}\n", word);
      std::exit(2);
    }
    *value = std::atoi(argv[i + 1]);
  }
  return options;
}

double area_of(const Surface& surface) {
  double area = 0;
  for (Index t = 0; t < surface.num_triangles(); ++t) {
    const Index* v = &surface.corner_vertex[3 * t];
    area += 0.5 * norm(cross(surface.position[v[1]] - surface.position[v[0]],
                             surface.position[v[2]] - surface.position[v[0]]));
  }
  return area;
}

/// Whether the surface goes on around a point, so that no segment crosses its jagged rim.
bool is_inside(const SurfaceLocator& locator, Vec3 at, double reach) {
  for (const Vec3 aside : {Vec3{reach, 0, 0}, Vec3{-reach, 0, 0}, Vec3{0, reach, 0}, Vec3{0, -reach, 0}}) {
    if (locator.nearest(at + aside).distance > 0.5 * reach) return false;
  }
  return true;
}

/// A walk over the surface in one direction of the xy plane, `step` a segment; shorter where the panel ends.
PolylineSource walk(const Surface& surface, const SurfaceLocator& locator, Index start, double angle,
                    Index segments, double step) {
  PolylineSource polyline;
  const Index* v = &surface.corner_vertex[3 * start];
  Vec3 at = (1.0 / 3) * (surface.position[v[0]] + surface.position[v[1]] + surface.position[v[2]]);
  polyline.point.push_back(at);
  const Vec3 ahead{step * std::cos(angle), step * std::sin(angle), 0};
  for (Index k = 0; k < segments; ++k) {
    const auto hit = locator.nearest(at + ahead);
    if (!is_inside(locator, hit.position, 8 * step)) break;
    at = hit.position;
    polyline.point.push_back(at);
  }
  polyline.max_distance = 0.5 * step;
  return polyline;
}

ConstraintSet make_polylines(const Exec& exec, const Surface& surface, const Options& options) {
  const SurfaceLocator locator(exec, surface);
  const double mean_edge = std::sqrt(4 / std::sqrt(3.0) * area_of(surface) / surface.num_triangles());
  const double step = 0.7 * mean_edge;  // about two edges crossed a segment
  ConstraintSet set;
  std::uint64_t state = 1;
  while (static_cast<Index>(set.features.size()) < options.polylines) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const auto start = static_cast<Index>((state >> 33) % surface.num_triangles());
    const double angle =
        0.5 * kPi * static_cast<double>((state >> 20) & 1023) / 1024;  // none against another
    auto polyline = walk(surface, locator, start, angle, options.segments, step);
    if (static_cast<Index>(polyline.point.size()) <= options.segments) continue;
    set.features.push_back({"p" + std::to_string(set.features.size()), std::move(polyline)});
  }
  return set;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  const Exec exec(options.threads);
  const auto sample =
      make_sample(exec, {.kind = "hood", .triangles = options.triangles, .noise = 0.0002, .seed = 1});
  if (!sample) return 1;
  const Surface surface = sample->mesh.surface();
  const ConstraintSet set = make_polylines(exec, surface, options);
  std::vector<double> seconds;
  for (Index run = 0; run < options.runs; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    const auto embedding = embed(surface, set, {.threads = static_cast<int>(options.threads)});
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (!embedding) {
      fmt::print(stderr, "{}\n", describe(embedding.error()));
      return 1;
    }
    const double ratio = area_of(embedding->surface()) / area_of(surface);
    if (std::abs(ratio - 1) > 1e-12) {
      fmt::print(stderr, "the area changed by {}\n", ratio - 1);
      return 1;
    }
    if (run > 0) continue;
    std::size_t steps = 0;
    for (const Feature& feature : embedding->features) steps += feature.vertex.size() - 1;
    fmt::print("{} triangles, {} polylines of {} segments: {} chain edges, {} new triangles\n",
               surface.num_triangles(), set.features.size(), options.segments, steps,
               embedding->surface().num_triangles() - surface.num_triangles());
  }
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2];
  fmt::print("embed: median {:.3f} s, least {:.3f} s, {:.0f} segments a second, {} threads\n", median,
             seconds.front(), static_cast<double>(options.polylines) * options.segments / median,
             exec.threads());
  return 0;
}
