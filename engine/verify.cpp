#include "engine/verify.hpp"

#include <algorithm>
#include <new>

#include "engine/prepare/prepare.hpp"
#include "engine/verify/benchmark.hpp"
#include "engine/verify/certificate.hpp"
#include "engine/verify/claims_check.hpp"
#include "engine/verify/constraint_checks.hpp"
#include "engine/verify/flat_surface.hpp"
#include "engine/verify/overlaps.hpp"

namespace planish {
namespace {

Result<void> check_uv(const Surface& surface, In<Vec2> corner_uv) {
  if (corner_uv.size() != surface.corner_vertex.size())
    return fail(ErrorCode::BadUsage, "there must be one uv a corner of each triangle");
  Error error{.code = ErrorCode::NonFinitePosition, .element = ElementKind::Triangle};
  for (Index t = 0; t < surface.num_triangles(); ++t) {
    const auto is_finite = [](Vec2 z) { return std::isfinite(z.x) && std::isfinite(z.y); };
    if (std::ranges::all_of(corner_uv.subspan(3 * static_cast<std::size_t>(t), 3), is_finite)) continue;
    if (error.ids.size() < kMaxListedIds) error.ids.push_back(t);
    ++error.count;
  }
  if (error.count == 0) return {};
  error.what = std::to_string(error.count) + " triangles have a uv that is not a finite number";
  return fail(error);
}

/// Claimed ids name what the mesh has.
Result<void> check_claims(const Surface& surface, const Claims& claims) {
  const auto outside = [](In<Index> ids, Index limit) {
    return std::ranges::any_of(ids, [&](Index id) { return id < 0 || id >= limit; });
  };
  bool wrong = false;
  for (const Feature& feature : claims.features) {
    wrong |=
        outside(feature.vertex, surface.num_vertices()) || outside(feature.triangle, surface.num_triangles());
  }
  for (const ConstraintOutcome& entry : claims.constraints) {
    wrong |= outside(entry.pinned, surface.num_vertices());
    for (const auto& edge : entry.edges) wrong |= outside(edge, surface.num_vertices());
  }
  if (!wrong) return {};
  return fail(ErrorCode::IndexOutOfRange, "claims name a vertex or triangle that the mesh does not have");
}

/// What the set names by number; what it names by name is for the checks to miss.
Result<void> check_set(const Surface& surface, const ConstraintSet& set) {
  const auto missing = [&](Index v) { return v < 0 || v >= surface.num_vertices(); };
  for (const Constraint& constraint : set.constraints) {
    bool wrong = false;
    if (const auto* pin = std::get_if<PinConstraint>(&constraint.rule))
      wrong = std::ranges::any_of(pin->vertex, missing);
    if (const auto* angle = std::get_if<AngleConstraint>(&constraint.rule))
      wrong =
          std::ranges::any_of(angle->edges, [&](const auto& e) { return missing(e[0]) || missing(e[1]); });
    if (const auto* direction = std::get_if<DirectionConstraint>(&constraint.rule))
      wrong = direction->edge && (missing((*direction->edge)[0]) || missing((*direction->edge)[1]));
    if (wrong)
      return fail(ErrorCode::ConstraintInvalid,
                  "constraint \"" + constraint.name + "\" names a vertex that the mesh does not have");
  }
  return {};
}

MeshFacts facts_of(const FlatSurface& flat) {
  const Topology& topology = flat.topology;
  const auto num_vertices = static_cast<Index>(flat.position.size());
  MeshFacts facts;
  facts.vertices = num_vertices;
  facts.triangles = flat.surface().num_triangles();
  facts.components = topology.num_components;
  facts.boundary_loops = topology.num_loops();
  facts.euler = num_vertices - topology.num_edges + facts.triangles;
  return facts;
}

/// What rounding can do to the shape of the smallest triangle, relative.
double rounding_of(const FlatSurface& flat, In<RestFrame> frame) {
  constexpr double kEpsilon = 0x1p-52, kSteps = 16;
  double farthest = 0, shortest = kInfinity;
  for (const Vec3 p : flat.position)
    farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  for (const RestFrame& f : frame) shortest = std::min({shortest, f.x1, f.y2});
  return kSteps * kEpsilon * farthest / shortest;
}

void measure(const Exec& exec, const FlatSurface& flat, In<RestFrame> frame, Verification& result) {
  Certificate& certificate = result.certificate;
  certificate = certify(exec, flat.surface(), flat.topology, frame, flat.uv);
  for (Index& v : certificate.overwound) v = flat.origin[v];
  std::sort(certificate.overwound.begin(), certificate.overwound.end());
  Overlaps overlaps = find_overlaps(exec, flat.corner_vertex, flat.uv, rest_areas(exec, frame));
  certificate.benchmark =
      benchmark_figures(exec, flat.corner_vertex, flat.topology, frame, flat.uv, overlaps);
  certificate.overlapping_pairs = overlaps.pairs;
  certificate.overlap_area_fraction = overlaps.map_area > 0 ? overlaps.common_area / overlaps.map_area : 0;
  result.overlapping = std::move(overlaps.first);
  result.triangles = flat.surface().num_triangles();
  result.charts = flat.topology.num_components;
  result.torn_edges = flat.torn_edges;
}

Verification verified(const Exec& exec, const Surface& surface, In<Vec2> corner_uv,
                      const Statements& statements) {
  Verification result;
  const FlatSurface flat = open_where_torn(exec, surface, corner_uv);
  std::vector<RestFrame> frame(flat.surface().num_triangles());
  exec.for_blocks(flat.surface().num_triangles(), kBlock,
                  [&](Index, Range r) { rest_frames(r, flat.position, flat.corner_vertex, frame); });
  measure(exec, flat, frame, result);
  if (statements.claims == nullptr) return result;
  const WrittenMap map(surface, corner_uv);
  result.faults = misreported(*statements.claims, result, facts_of(flat), map, rounding_of(flat, frame));
  result.constraints = check_constraints({&map, statements.claims, statements.set}, result.faults);
  return result;
}

}  // namespace

Result<Verification> verify(const Surface& surface, In<Vec2> corner_uv, const Statements& statements,
                            const VerifyOptions& options) try {
  if (statements.set != nullptr && statements.claims == nullptr)
    return fail(ErrorCode::BadUsage, "constraints are verified with the report, which has their features");
  const Exec exec(options.threads);
  if (auto sound = manifold_topology(exec, surface); !sound) return fail(sound.error());
  if (auto checked = check_uv(surface, corner_uv); !checked) return fail(checked.error());
  if (statements.claims != nullptr) {
    if (auto checked = check_claims(surface, *statements.claims); !checked) return fail(checked.error());
  }
  if (statements.set != nullptr) {
    if (auto checked = check_set(surface, *statements.set); !checked) return fail(checked.error());
  }
  return verified(exec, surface, corner_uv, statements);
} catch (const std::bad_alloc&) {
  return fail(ErrorCode::OutOfMemory,
              "not enough memory to verify " + std::to_string(surface.num_triangles()) + " triangles");
}

}  // namespace planish
