#include "io/report_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/benchmark_names.hpp"

namespace planish {
namespace {

using Json = nlohmann::ordered_json;  // fields in the order of DESIGN 4.3

/// JSON has no infinity: null.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json first_ids(In<Index> ids) {
  Json list = Json::array();
  for (const Index id : ids.first(std::min(ids.size(), kMaxListedIds))) list.push_back(id);
  return list;
}

Json spread(const Spread& s) {
  return {{"min", number(s.min)}, {"max", number(s.max)}, {"mean", number(s.mean)},
          {"p1", number(s.p1)},   {"p50", number(s.p50)}, {"p99", number(s.p99)}};
}

Json mesh_facts(const MeshFacts& m) {
  return {{"vertices", m.vertices},
          {"unreferenced_vertices", m.unreferenced_vertices},
          {"duplicate_positions", m.duplicate_positions},
          {"triangles", m.triangles},
          {"components", m.components},
          {"boundary_loops", m.boundary_loops},
          {"euler", m.euler},
          {"outer", m.outer},
          {"mollified_triangles", m.mollified_triangles}};
}

void add_certificate(Json& report, const Certificate& c) {
  report["energy"] = {{"arap", number(c.arap)}, {"symmetric_dirichlet", number(c.symmetric_dirichlet)}};
  report["stretch"] = {{"sigma_max", spread(c.sigma_max)},
                       {"sigma_min", spread(c.sigma_min)},
                       {"area_ratio", spread(c.area_ratio)},
                       {"angle_distortion", spread(c.angle_distortion)}};
  report["flipped_triangles"] = c.flipped_triangles;
  report["flipped_ids"] = first_ids(c.flipped);
  report["overwound_vertices"] = c.overwound_vertices;
  report["overwound_ids"] = first_ids(c.overwound);
  report["overlapping_pairs"] = c.overlapping_pairs;
  report["overlapping_ids"] = c.overlapping;
  report["overlap_area_fraction"] = number(c.overlap_area_fraction);
  for (const auto& [figure, value] : named_figures(c.benchmark)) report["benchmark"][figure] = number(value);
}

void add_iteration(Json& report, const Flattening& f) {
  report["iterations"] = f.iterations;
  report["converged"] = f.converged;
  report["gradient"] = number(f.gradient);
  report["holonomy_residual"] = number(f.holonomy_residual);
  Json history = Json::array();
  for (const Iterate& i : f.history) {
    history.push_back({{"iteration", i.iteration},
                       {"energy", number(i.energy)},
                       {"gradient", number(i.gradient)},
                       {"phase", name(i.phase)}});
  }
  report["history"] = std::move(history);
}

void add_flips(Json& report, const FlipRemoval& r) {
  Json& flips = report["flips"];
  flips = {{"method", name(r.method)}};
  if (r.method != Flips::Untangle) return;
  flips["flipped_before"] = r.flipped_before;
  flips["overwound_before"] = r.overwound_before;
  flips["arap_before"] = number(r.arap_before);
  flips["patch_steps"] = r.patch_steps;
  flips["untangling_steps"] = r.untangling_steps;
  flips["newton_steps"] = r.newton_steps;
  if (r.newton_steps == 0) return;
  flips["energy"] = number(r.energy);
  if (r.barrier_weight > 0) flips["barrier"] = {{"mu", r.barrier_weight}, {"delta", r.barrier_delta}};
}

void add_overlaps(Json& report, const OverlapRemoval& r) {
  Json& overlaps = report["overlaps"];
  overlaps = {{"method", name(r.method)}};
  if (r.method != Overlapping::Remove) return;
  overlaps["pairs_before"] = r.pairs_before;
  if (r.pairs_before == 0) return;
  overlaps["energy_before"] = number(r.energy_before);
  overlaps["start"] = name(r.start);
  if (r.start == OverlapRemoval::Start::None) return;
  overlaps["newton_steps"] = r.newton_steps;
  overlaps["energy"] = number(r.energy);
}

/// Seconds of each step; a step that ran more than once has its sum.
Json timings(const std::vector<StepTime>& engine, const std::vector<StepTime>& extra) {
  Json seconds = Json::object();
  for (const auto* list : {&engine, &extra}) {
    for (const StepTime& s : *list) seconds[s.step] = number(seconds.value(s.step, 0.0) + s.seconds);
  }
  return seconds;
}

Json repairs(const std::vector<Mending>& mendings) {
  Json list = Json::array();
  for (const Mending& m : mendings) {
    list.push_back({{"what", m.what}, {"count", m.count}, {"ids", first_ids(m.ids)}});
  }
  return list;
}

Json point(Vec3 p) { return Json::array({number(p.x), number(p.y), number(p.z)}); }

Json defect(const Defect& d) {
  return {{"code", name(d.code)},
          {"element", name(d.element)},
          {"ids", first_ids(d.ids)},
          {"count", d.count},
          {"remedy", remedy(d.code)}};
}

Json feature_facts(const Feature& feature) {
  if (feature.is_region()) return {{"triangles", feature.triangle}};
  return {{"vertices", feature.vertex},
          {"closed", feature.closed},
          {"length", number(feature.length)},
          {"max_deviation", number(feature.max_deviation)}};
}

void add_embedding(Json& report, const Embedding& e) {
  // Every triangle of the input has at least one part, so the last origin tells their number.
  const Index input_triangles =
      e.triangle_origin.empty() ? 0 : *std::ranges::max_element(e.triangle_origin) + 1;
  report["embedding"] = {{"vertices_added", e.vertex_origin.size()},
                         {"triangles_added", static_cast<Offset>(e.triangle_origin.size()) - input_triangles},
                         {"snapped_points", e.snapped_points}};
  report["refinement"] = {{"feasibility_splits", e.feasibility_splits}};
  report["features"] = Json::object();
  for (const Feature& feature : e.features) report["features"][feature.name] = feature_facts(feature);
}

template <class T>
Json optional(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json outcome_json(const ConstraintOutcome& c) {
  Json json = {{"name", c.name}, {"type", c.type}};
  const bool relates = c.degrees.has_value();
  if (relates && c.type != "direction") {
    if (!c.features.empty()) json["features"] = c.features;
    if (!c.edges.empty()) json["edges"] = c.edges;
  } else {
    if (!c.features.empty()) json["feature"] = c.features.front();
    if (!c.edges.empty()) json["edge"] = c.edges.front();
    if (!c.pinned.empty()) json["vertices"] = c.pinned;
  }
  if (c.side != 0) json["side"] = c.side;
  json["residual"] = number(c.residual);
  json["residual_abs"] = number(c.residual_abs);
  if (relates) json["degrees"] = optional(c.degrees);
  if (relates || !c.pinned.empty()) return json;
  json["scale"] = optional(c.scale);
  json["orientation"] = optional(c.orientation);
  json["template"] = nullptr;
  if (!c.shape.empty()) {
    json["template"] = Json::array();
    for (const Vec2 t : c.shape) json["template"].push_back({number(t.x), number(t.y)});
  }
  json["mirrored"] = c.mirrored;
  if (c.chirality_open) json["chirality_open"] = true;
  json["planarity"] = optional(c.planarity);
  json["mismatch"] = number(c.mismatch);
  json["yielded"] = c.yielded;
  if (!c.yielded_to.empty()) json["yielded_to"] = c.yielded_to;
  if (c.type == "line") json["keeps_order"] = c.keeps_order;
  return json;
}

void add_constraints(Json& report, const ConstraintFacts& facts) {
  report["constraints"] = Json::array();
  for (const ConstraintOutcome& c : facts.outcome) report["constraints"].push_back(outcome_json(c));
  report["elimination"] = {{"bodies", facts.bodies},
                           {"assemblies", facts.assemblies},
                           {"clusters", facts.clusters},
                           {"border_unknowns", facts.border_unknowns},
                           {"factor_nonzeros", facts.factor_nonzeros}};
}

void add_deformation(Json& report, const DeformFacts& facts) {
  Json& deformation = report["deformation"];
  deformation = {{"reference", name(facts.reference)},
                 {"poses", name(facts.poses)},
                 {"steps", facts.steps},
                 {"map_scale", number(facts.map_scale)},
                 {"mirrored", facts.mirrored},
                 {"release", name(facts.release)},
                 {"given_arap", number(facts.given_arap)},
                 {"given_flipped", facts.given_flipped},
                 {"largest_displacement", number(facts.largest_displacement)},
                 {"mean_displacement", number(facts.mean_displacement)}};
  Json& way = deformation["way"] = Json::array();
  for (const StepFacts& step : facts.way)
    way.push_back({{"step", step.step},
                   {"arap", number(step.arap)},
                   {"flipped_triangles", step.flipped},
                   {"overwound_vertices", step.overwound}});
}

void add_price(Json& report, const Price& price) {
  Json items = Json::array();
  for (const ConstraintPrice& item : price.constraints) {
    const bool known = item.reason.empty();
    Json json = {{"name", item.name},
                 {"energy_without", known ? number(item.energy_without) : Json(nullptr)},
                 {"cost", known ? number(item.cost) : Json(nullptr)}};
    if (!known) json["reason"] = item.reason;
    items.push_back(std::move(json));
  }
  report["price"] = {{"energy", number(price.energy)},
                     {"unconstrained", number(price.unconstrained)},
                     {"without_refit", number(price.without_refit)},
                     {"constraints", std::move(items)}};
}

void add_cut(Json& report, const CutFacts& cut) {
  report["cut"] = {
      {"cut_edges", cut.cut_edges}, {"cut_length", number(cut.cut_length)}, {"charts", cut.charts}};
}

Json head(const ReportContext& context) {
  return {
      {"version", 1}, {"planish", PLANISH_VERSION}, {"command", context.command}, {"input", context.input}};
}

/// Numbers so that they read back bit for bit; bytes of names and paths that are not UTF-8 as U+FFFD.
std::string written(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json finding_json(const ConstraintFinding& finding) {
  Json json = {{"name", finding.name}, {"type", finding.type}};
  if (finding.side != 0) json["side"] = finding.side;
  json["residual"] = finding.residual ? number(*finding.residual) : Json(nullptr);
  json["allowed"] = finding.allowed;
  json["unit"] = finding.degrees ? "degrees" : "size";
  if (!finding.unmeasured.empty()) json["unmeasured"] = finding.unmeasured;
  json["faults"] = finding.faults;
  return json;
}

Json path_or_null(const std::string& path) { return path.empty() ? Json(nullptr) : Json(path); }

}  // namespace

std::string report_json(const Flattening& flattening, const ReportContext& context,
                        const ReportParts& parts) {
  Json report = head(context);
  report["method"] = name(flattening.method);
  if (!flattening.up_to_scale.empty()) report["up_to_scale"] = flattening.up_to_scale;
  if (const auto& intrinsic = flattening.intrinsic)
    report["intrinsic"] = {{"moved_edges", intrinsic->moved_edges},
                           {"angle_defect", intrinsic->angle_defect}};
  report["mesh"] = mesh_facts(flattening.mesh);
  if (parts.embedding != nullptr) add_embedding(report, *parts.embedding);
  if (parts.cut != nullptr) add_cut(report, *parts.cut);
  if (flattening.constraints.bodies > 0 || !flattening.constraints.outcome.empty())
    add_constraints(report, flattening.constraints);
  if (parts.price != nullptr) add_price(report, *parts.price);
  if (parts.deformation != nullptr) add_deformation(report, *parts.deformation);
  add_certificate(report, flattening.certificate);
  add_iteration(report, flattening);
  add_flips(report, flattening.removal);
  add_overlaps(report, flattening.overlaps);
  report["timings_s"] = timings(flattening.timings, context.extra_timings);
  report["peak_memory_bytes"] = context.peak_memory_bytes;
  if (!context.peaks.empty()) {
    Json& peaks = report["peak_memory_by_step_bytes"] = Json::object();
    for (const StepPeak& peak : context.peaks) peaks[peak.step] = peak.bytes;
  }
  report["threads"] = flattening.threads;
  report["repairs"] = repairs(context.mendings);
  report["warnings"] = context.warnings;
  return written(report);
}

std::string embed_report_json(const Embedding& embedding, const ReportContext& context, const CutFacts* cut) {
  Json report = head(context);
  add_embedding(report, embedding);
  if (cut != nullptr) add_cut(report, *cut);
  report["timings_s"] = timings({}, context.extra_timings);
  report["peak_memory_bytes"] = context.peak_memory_bytes;
  report["repairs"] = repairs(context.mendings);
  report["warnings"] = context.warnings;
  return written(report);
}

std::string diagnosis_json(const Diagnosis& diagnosis, const std::string& input,
                           const std::vector<Mending>& mendings, const std::vector<std::string>& warnings) {
  const Diagnosis& d = diagnosis;
  Json json;
  json["version"] = 1;
  json["planish"] = PLANISH_VERSION;
  json["input"] = input;
  json["vertices"] = d.vertices;
  json["triangles"] = d.triangles;
  json["unreferenced_vertices"] = d.unreferenced_vertices;
  json["duplicate_positions"] = d.duplicate_positions;
  json["components"] = d.components;
  json["boundary_loops"] = d.boundary_loops;
  json["loop_lengths"] = Json::array();
  for (const double length : d.loop_lengths) json["loop_lengths"].push_back(number(length));
  json["boundary_edges"] = d.boundary_edges;
  json["euler"] = d.euler;
  json["genus"] = d.genus == kNone ? Json(nullptr) : Json(d.genus);
  json["area"] = number(d.area);
  json["lower"] = point(d.lower);
  json["upper"] = point(d.upper);
  json["min_angle"] = number(d.min_angle);
  json["max_angle"] = number(d.max_angle);
  json["defects"] = Json::array();
  for (const Defect& found : d.defects) json["defects"].push_back(defect(found));
  json["usable"] = d.usable();
  json["repairs"] = repairs(mendings);
  json["warnings"] = warnings;
  return written(json);
}

std::string verification_json(const Verification& verification, const VerificationContext& context) {
  const Verification& v = verification;
  Json json;
  json["version"] = 1;
  json["planish"] = PLANISH_VERSION;
  json["mesh"] = context.mesh;
  json["report"] = path_or_null(context.report);
  json["constraint_file"] = path_or_null(context.constraints);
  json["uv_set"] = context.uv_set;
  json["other_uv_sets"] = context.other_sets;
  json["holds"] = v.holds();
  json["triangles"] = v.triangles;
  json["charts"] = v.charts;
  json["torn_edges"] = v.torn_edges;
  add_certificate(json, v.certificate);
  json["overlapping_ids"] = v.overlapping;
  json["constraints"] = Json::array();
  for (const ConstraintFinding& finding : v.constraints) json["constraints"].push_back(finding_json(finding));
  json["faults"] = v.faults;
  json["warnings"] = context.warnings;
  return written(json);
}

std::string error_json(const Error& error) {
  const Place& place = error.place;
  const auto known = [](Offset value, bool is_known) { return is_known ? Json(value) : Json(nullptr); };
  Json json;
  json["code"] = name(error.code);
  json["exit_code"] = exit_code(error.code);
  json["message"] = error.what;
  json["also"] = error.also;
  json["file"] = place.file.empty() ? Json(nullptr) : Json(place.file);
  json["line"] = known(place.line, place.line > 0);
  json["column"] = known(place.column, place.column > 0);
  json["byte"] = known(place.byte, place.byte >= 0);
  json["pointer"] = place.pointer.empty() ? Json(nullptr) : Json(place.pointer);
  json["element"] = name(error.element);
  json["ids"] = first_ids(error.ids);
  json["count"] = error.count;
  json["remedy"] = remedy(error.code);
  return written({{"error", json}});
}

}  // namespace planish
