#include "engine/cut.hpp"

#include <algorithm>
#include <new>

#include "engine/features/one_ring.hpp"
#include "engine/prepare/cut.hpp"
#include "engine/prepare/cut_graph.hpp"
#include "engine/prepare/validate.hpp"

namespace planish {
namespace {

/// Half-edges of a chain, in whichever direction triangles have them.
void add_corners(const Surface& surface, const Topology& topology, const Feature& chain,
                 std::vector<Index>& corners) {
  const std::size_t n = chain.vertex.size();
  for (std::size_t i = 0; i + (chain.closed ? 0 : 1) < n; ++i) {
    const Index u = chain.vertex[i], v = chain.vertex[(i + 1) % n];
    const Index there = half_edge(surface, topology, u, v), back = half_edge(surface, topology, v, u);
    corners.push_back(there == kNone ? back : there);
  }
}

Result<std::vector<Index>> seam_corners(const Surface& surface, const Topology& topology,
                                        const std::vector<Feature>& features,
                                        const std::vector<std::string>& seams) {
  std::vector<Index> corners;
  for (std::size_t k = 0; k < seams.size(); ++k) {
    const auto feature =
        std::find_if(features.begin(), features.end(), [&](const Feature& f) { return f.name == seams[k]; });
    if (feature == features.end() || feature->vertex.empty()) {
      Error error{
          .code = ErrorCode::ConstraintInvalid,
          .what = "seam \"" + seams[k] + "\" is " +
                  (feature == features.end() ? "no feature" : "a region, which has no edges to open")};
      error.place.pointer = "/seams/" + std::to_string(k);
      return fail(error);
    }
    add_corners(surface, topology, *feature, corners);
  }
  return corners;
}

Result<Cut> cut_open(const Exec& exec, const Surface& surface, const std::vector<Feature>& features,
                     const std::vector<std::string>& seams, CutMode mode) {
  if (auto checked = check_manifold(exec, surface); !checked) return fail(checked.error());
  const Topology topology = build_topology(exec, surface);
  auto corners = seam_corners(surface, topology, features, seams);
  if (!corners) return fail(corners.error());
  CutSurface opened = open_along(exec, surface, topology, *corners);
  if (mode == CutMode::Auto) {
    // Triangles keep their corners when opened, so the corners of both steps are those of the input.
    const Topology parted = build_topology(exec, opened.surface());
    std::vector<Index> preferred;
    for (const Feature& feature : features) add_corners(surface, topology, feature, preferred);
    std::erase_if(preferred, [&](Index c) { return parted.corner_twin[c] == kNone; });
    const CutGraph graph = find_cut_graph(exec, opened.surface(), parted, preferred);
    corners->insert(corners->end(), graph.corner.begin(), graph.corner.end());
    opened = open_along(exec, surface, topology, *corners);
  }
  Cut result{.position = std::move(opened.position),
             .corner_vertex = std::move(opened.corner_vertex),
             .vertex_origin = std::move(opened.vertex_origin),
             .edges = opened.num_cut_edges,
             .length = opened.cut_length};
  result.charts = build_topology(exec, result.surface()).num_components;
  return result;
}

}  // namespace

Result<Cut> cut(const Surface& surface, const std::vector<Feature>& features,
                const std::vector<std::string>& seams, const CutOptions& options) {
  if (options.threads < 0) return fail(ErrorCode::BadUsage, "threads must not be negative");
  try {
    return cut_open(Exec(options.threads), surface, features, seams, options.mode);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory,
                "not enough memory to cut " + std::to_string(surface.num_triangles()) + " triangles open");
  }
}

}  // namespace planish
