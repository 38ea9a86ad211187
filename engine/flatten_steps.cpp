#include "engine/flatten_steps.hpp"

#include <algorithm>

#include "engine/flatten.hpp"
#include "engine/verify/benchmark.hpp"
#include "engine/verify/certificate.hpp"
#include "engine/verify/overlaps.hpp"
#include "engine/verify/simple_boundary.hpp"

namespace planish {
namespace {

void to_input_ids(std::vector<Index>& ids, In<Index> origin) {
  for (Index& id : ids) id = origin[id];
  std::sort(ids.begin(), ids.end());
}

std::vector<RestFrame> frames_in_mesh_units(const Workpiece& piece) {
  const double unit = piece.mesh().unit;
  std::vector<RestFrame> frame = piece.geometry.frame;
  for (RestFrame& f : frame) f = {unit * f.x1, unit * f.x2, unit * f.y2};
  return frame;
}

}  // namespace

MeshFacts mesh_facts(const Workpiece& piece) {
  const Diagnosis& diagnosis = piece.prepared.diagnosis;
  const std::vector<std::uint8_t>& mollified = piece.geometry.mollified;
  return {.vertices = diagnosis.vertices,
          .unreferenced_vertices = diagnosis.unreferenced_vertices,
          .duplicate_positions = diagnosis.duplicate_positions,
          .triangles = diagnosis.triangles,
          .components = diagnosis.components,
          .boundary_loops = diagnosis.boundary_loops,
          .euler = diagnosis.euler,
          .outer = {},
          .mollified_triangles = static_cast<Index>(std::count(mollified.begin(), mollified.end(), 1))};
}

std::vector<Feature> features_in_order(const OrderedMesh& mesh, const std::vector<Feature>* features) {
  if (features == nullptr) return {};
  std::vector<Index> vertex(mesh.num_input_vertices, kNone), triangle(mesh.num_triangles(), kNone);
  for (Index v = 0; v < mesh.num_vertices(); ++v) vertex[mesh.vertex_origin[v]] = v;
  for (Index t = 0; t < mesh.num_triangles(); ++t) triangle[mesh.triangle_origin[t]] = t;
  std::vector<Feature> ordered = *features;
  for (Feature& feature : ordered) {
    for (Index& v : feature.vertex) v = vertex[v];
    for (Index& t : feature.triangle) t = triangle[t];
    std::sort(feature.triangle.begin(), feature.triangle.end());
  }
  return ordered;
}

Result<std::vector<Index>> choose_outer(const Workpiece& piece, In<Feature> features,
                                        const std::string& name) {
  if (name.empty()) return outer_loops(piece.topology());
  const auto feature =
      std::find_if(features.begin(), features.end(), [&](const Feature& f) { return f.name == name; });
  const bool on_boundary =
      feature != features.end() && !feature->is_region() &&
      std::all_of(feature->vertex.begin(), feature->vertex.end(), [&](Index v) {
        return piece.loop_of[v] != kNone && piece.loop_of[v] == piece.loop_of[feature->vertex.front()];
      });
  if (!on_boundary) {
    Error error{.code = ErrorCode::ConstraintInvalid, .what = "outer: \"" + name + "\" is no boundary loop"};
    error.place.pointer = "/outer";
    return fail(error);
  }
  return outer_loops(piece.topology(), piece.loop_of[feature->vertex.front()]);
}

Result<std::vector<Vec2>> map_region(const Surface& region, int threads, const Monitor& monitor) {
  const Monitor stop = [&](const Progress&) {
    return monitor ? monitor({.phase = Phase::Compile}) : Verdict::Continue;
  };
  auto flat = flatten(region, {.threads = threads}, stop);
  if (!flat) return fail(flat.error());
  const Certificate& certificate = flat->certificate;
  if (const Offset flips = certificate.flipped_triangles + certificate.overwound_vertices; flips > 0) {
    return fail(ErrorCode::ConstraintsConflict, "its own flattening turns over or overwinds it at " +
                                                    std::to_string(flips) + " places; make it smaller");
  }
  return std::move(flat->uv);
}

ConstraintFacts constraint_facts(const ConstraintSystem& system, const DofMap& dof, Offset factor_nonzeros) {
  return {.outcome = {},
          .bodies = static_cast<Index>(system.compiled().bodies.size()),
          .assemblies = system.assemblies().size(),
          .clusters = system.orientation().clusters.size(),
          .border_unknowns = dof.num_border(),
          .factor_nonzeros = factor_nonzeros};
}

Certificate measure_without_overlaps(const Exec& exec, const Workpiece& piece, In<Vec2> uv) {
  const OrderedMesh& mesh = piece.mesh();
  const std::vector<RestFrame> frame = frames_in_mesh_units(piece);
  Certificate certificate = certify(exec, mesh.surface(), piece.topology(), frame, uv);
  to_input_ids(certificate.flipped, mesh.triangle_origin);
  to_input_ids(certificate.overwound, mesh.vertex_origin);
  return certificate;
}

Certificate measure_map(const Exec& exec, const Workpiece& piece, In<Vec2> uv) {
  Certificate certificate = measure_without_overlaps(exec, piece, uv);
  const std::vector<RestFrame> frame = frames_in_mesh_units(piece);
  Overlaps overlaps;
  if (!covers_once(exec, piece.mesh().corner_vertex, piece.topology(), uv))
    overlaps = find_overlaps(exec, piece.mesh().corner_vertex, uv, rest_areas(exec, frame));
  certificate.benchmark =
      benchmark_figures(exec, piece.mesh().corner_vertex, piece.topology(), frame, uv, overlaps);
  certificate.overlapping_pairs = overlaps.pairs;
  certificate.overlap_area_fraction = overlaps.map_area > 0 ? overlaps.common_area / overlaps.map_area : 0;
  for (std::array<Index, 2>& pair : overlaps.first) {
    for (Index& t : pair) t = piece.mesh().triangle_origin[t];
    std::sort(pair.begin(), pair.end());
  }
  std::sort(overlaps.first.begin(), overlaps.first.end());
  certificate.overlapping = std::move(overlaps.first);
  return certificate;
}

std::vector<Vec2> in_input_order(const OrderedMesh& mesh, In<Vec2> uv) {
  std::vector<Vec2> result(mesh.num_input_vertices);
  for (Index v = 0; v < mesh.num_vertices(); ++v) result[mesh.vertex_origin[v]] = uv[v];
  return result;
}

}  // namespace planish
