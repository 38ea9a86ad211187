#include "engine/cut.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "engine/features/feature_error.hpp"
#include "engine/features/one_ring.hpp"
#include "engine/prepare/cut.hpp"
#include "engine/prepare/cut_graph.hpp"
#include "engine/prepare/prepare.hpp"

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

Failure bad_seam(const std::vector<std::string>& seams, std::size_t k, const std::string& what) {
  Error error{.code = ErrorCode::ConstraintInvalid, .what = "seam \"" + seams[k] + "\" " + what};
  error.place.pointer = "/seams/" + std::to_string(k);
  return fail(error);
}

/// Half-edges of each seam.
Result<std::vector<std::vector<Index>>> seam_corners(const Surface& surface, const Topology& topology,
                                                     const std::vector<Feature>& features,
                                                     const std::vector<std::string>& seams) {
  std::vector<std::vector<Index>> corners(seams.size());
  for (std::size_t k = 0; k < seams.size(); ++k) {
    const auto feature =
        std::find_if(features.begin(), features.end(), [&](const Feature& f) { return f.name == seams[k]; });
    if (feature == features.end()) return bad_seam(seams, k, "is no feature");
    if (feature->vertex.empty()) return bad_seam(seams, k, "is a region, which has no edges to open");
    add_corners(surface, topology, *feature, corners[k]);
  }
  return corners;
}

bool is_parted(const Topology& topology, const CutSurface& opened, Index c) {
  const Index twin = topology.corner_twin[c];
  return twin != kNone && (opened.corner_vertex[c] != opened.corner_vertex[next_corner(twin)] ||
                           opened.corner_vertex[next_corner(c)] != opened.corner_vertex[twin]);
}

Result<void> check_opened(const Topology& topology, const CutSurface& opened,
                          const std::vector<std::vector<Index>>& seam,
                          const std::vector<std::string>& seams) {
  for (std::size_t k = 0; k < seam.size(); ++k) {
    const auto parted = [&](Index c) { return is_parted(topology, opened, c); };
    if (std::none_of(seam[k].begin(), seam[k].end(), parted)) {
      return bad_seam(
          seams, k,
          "opens nothing: it runs along the boundary, or is a single edge inside the surface, whose ends "
          "keep it shut; make it longer, or let it reach the boundary or another seam");
    }
  }
  return {};
}

Result<Cut> cut_open(const Exec& exec, const Surface& surface, const std::vector<Feature>& features,
                     const std::vector<std::string>& seams, CutMode mode, In<Vec2> corner_uv = {}) {
  auto sound = manifold_topology(exec, surface);
  if (!sound) return fail(sound.error());
  const Topology& topology = *sound;
  const auto seam = seam_corners(surface, topology, features, seams);
  if (!seam) return fail(seam.error());
  std::vector<Index> corners;
  if (!corner_uv.empty()) corners = torn_half_edges(topology.corner_twin, corner_uv);
  for (const std::vector<Index>& c : *seam) corners.insert(corners.end(), c.begin(), c.end());
  CutSurface opened = open_along(exec, surface, topology, corners);
  if (auto done = check_opened(topology, opened, *seam, seams); !done) return fail(done.error());
  if (mode == CutMode::Auto) {
    // Triangles keep their corners when opened, so the corners of both steps are those of the input.
    const Topology parted = build_topology(exec, opened.surface());
    std::vector<Index> preferred;
    for (const Feature& feature : features) add_corners(surface, topology, feature, preferred);
    std::erase_if(preferred, [&](Index c) { return parted.corner_twin[c] == kNone; });
    const CutGraph graph = find_cut_graph(exec, opened.surface(), parted, preferred);
    corners.insert(corners.end(), graph.corner.begin(), graph.corner.end());
    opened = open_along(exec, surface, topology, corners);
  }
  Cut result{.position = std::move(opened.position),
             .corner_vertex = std::move(opened.corner_vertex),
             .vertex_origin = std::move(opened.vertex_origin),
             .edges = opened.num_cut_edges,
             .length = opened.cut_length};
  result.charts = build_topology(exec, result.surface()).num_components;
  return result;
}

Result<void> check_uv(const Surface& surface, In<Vec2> corner_uv) {
  if (corner_uv.size() != surface.corner_vertex.size())
    return fail(ErrorCode::BadUsage, "there must be one uv a corner of each triangle");
  OffendingIds bad;
  for (Index t = 0; t < surface.num_triangles(); ++t) {
    const auto is_finite = [](Vec2 z) { return std::isfinite(z.x) && std::isfinite(z.y); };
    if (!std::ranges::all_of(corner_uv.subspan(3 * static_cast<std::size_t>(t), 3), is_finite)) bad.add(t);
  }
  if (bad.empty()) return {};
  Error error{.code = ErrorCode::NonFinitePosition,
              .what = std::to_string(bad.count()) + " triangles have a uv that is not a finite number"};
  return fail(bad.of(std::move(error), ElementKind::Triangle));
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

Result<OpenedMap> cut_where_torn(const Surface& surface, In<Vec2> corner_uv,
                                 const std::vector<Feature>& features, const std::vector<std::string>& seams,
                                 int threads) {
  if (threads < 0) return fail(ErrorCode::BadUsage, "threads must not be negative");
  if (auto checked = check_uv(surface, corner_uv); !checked) return fail(checked.error());
  try {
    auto opened = cut_open(Exec(threads), surface, features, seams, CutMode::None, corner_uv);
    if (!opened) return fail(opened.error());
    OpenedMap map{.cut = std::move(*opened), .uv = {}};
    map.uv.resize(map.cut.position.size());
    for (std::size_t c = 0; c < corner_uv.size(); ++c) map.uv[map.cut.corner_vertex[c]] = corner_uv[c];
    return map;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory,
                "not enough memory to cut " + std::to_string(surface.num_triangles()) + " triangles open");
  }
}

}  // namespace planish
