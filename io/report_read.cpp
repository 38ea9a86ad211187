#include "io/report_read.hpp"

#include <new>

#include "io/file.hpp"
#include "io/report_read_parts.hpp"

namespace planish {
namespace {

/// Whether the text is a report of flatten, of a version that is read here.
bool check_kind(JsonReader& reader, const JsonValue& root) {
  if (!reader.expect(root, JsonKind::Object, "a report (an object)")) return false;
  const auto version = reader.required(root, "version");
  if (version && reader.number(*version) != 1)
    reader.fault(*version, "this program reads version 1, found " + version->described());
  if (!reader.failed() && !root.member("energy") && root.member("embedding"))
    reader.fault(root, "this is a report of embed, which has no map; give one of flatten");
  return !reader.failed();
}

void read_mesh_facts(ReportReader& report, const JsonValue& root, Claims& claims) {
  JsonReader& reader = report.reader;
  const auto mesh = report.object(root, "mesh");
  if (!mesh) return;
  claims.mesh.vertices = report.count(*mesh, "vertices");
  claims.mesh.triangles = report.count(*mesh, "triangles");
  claims.mesh.components = report.count(*mesh, "components");
  claims.mesh.boundary_loops = report.count(*mesh, "boundary_loops");
  claims.mesh.euler = static_cast<Index>(report.number(*mesh, "euler"));
  if (const auto cut = root.member("cut")) claims.cut_edges = report.count(*cut, "cut_edges");
  if (reader.failed()) return;
  const auto differs = [&](const char* what, Index stated, Index found) {
    reader.fault(*mesh->member(what),
                 "the report is of a mesh with " + std::to_string(stated) + " " + what + ", this one has " +
                     std::to_string(found),
                 ErrorCode::ReportOfOtherMesh);
  };
  if (claims.mesh.triangles != report.mesh.triangles)
    return differs("triangles", claims.mesh.triangles, report.mesh.triangles);
  // A cut gives vertices copies, which are counted.
  const bool fits = claims.cut_edges ? claims.mesh.vertices >= report.mesh.vertices
                                     : claims.mesh.vertices == report.mesh.vertices;
  if (!fits) differs("vertices", claims.mesh.vertices, report.mesh.vertices);
}

void read_certificate(ReportReader& report, const JsonValue& root, Certificate& certificate) {
  const auto energy = report.object(root, "energy"), stretch = report.object(root, "stretch");
  if (!energy || !stretch) return;
  certificate.arap = report.number(*energy, "arap");
  certificate.symmetric_dirichlet = report.number(*energy, "symmetric_dirichlet");
  certificate.sigma_max = report.spread(*stretch, "sigma_max");
  certificate.sigma_min = report.spread(*stretch, "sigma_min");
  certificate.area_ratio = report.spread(*stretch, "area_ratio");
  certificate.angle_distortion = report.spread(*stretch, "angle_distortion");
  certificate.flipped_triangles = report.count(root, "flipped_triangles");
  certificate.flipped = report.triangles(root, "flipped_ids");
  certificate.overwound_vertices = report.count(root, "overwound_vertices");
  certificate.overwound = report.vertices(root, "overwound_ids");
  // Pairs can be more than an index counts.
  certificate.overlapping_pairs = static_cast<Offset>(report.number(root, "overlapping_pairs"));
  certificate.overlap_area_fraction = report.number(root, "overlap_area_fraction");
  const auto benchmark = report.object(root, "benchmark");
  if (!benchmark) return;
  BenchmarkFigures& b = certificate.benchmark;
  b.max_area_distortion = report.number(*benchmark, "max_area_distortion");
  b.average_area_error = report.number(*benchmark, "average_area_error");
  b.min_singular_value = report.number(*benchmark, "min_singular_value");
  b.max_singular_value = report.number(*benchmark, "max_singular_value");
  b.proportion_flipped_triangles = report.number(*benchmark, "proportion_flipped_triangles");
  b.bijectivity_violation_area = report.number(*benchmark, "bijectivity_violation_area");
  b.max_angle_distortion = report.number(*benchmark, "max_angle_distortion");
  b.average_angle_error = report.number(*benchmark, "average_angle_error");
  b.resolution = report.number(*benchmark, "resolution");
}

Claims read_claims(JsonReader& reader, const JsonValue& root, MeshSize mesh) {
  Claims claims;
  if (!check_kind(reader, root)) return claims;
  ReportReader report{reader, mesh};
  read_mesh_facts(report, root, claims);
  if (reader.failed()) return claims;
  if (const auto features = root.member("features")) claims.features = report.features(*features);
  if (const auto entries = root.member("constraints")) claims.constraints = report.constraints(*entries);
  read_certificate(report, root, claims.certificate);
  return claims;
}

}  // namespace

Result<Claims> read_report(const Exec& exec, const std::string& path, MeshSize mesh) {
  const auto bytes = FileBytes::open(path, exec);
  if (!bytes) return fail(bytes.error());
  return parse_report(bytes->view(), path, mesh);
}

Result<Claims> parse_report(std::string_view text, const std::string& file, MeshSize mesh) try {
  const auto document = JsonDocument::parse(text, file);
  if (!document) return fail(document.error());
  JsonReader reader(file);
  Claims claims = read_claims(reader, document->root(), mesh);
  if (reader.failed()) return fail(reader.take_fault());
  return claims;
} catch (const std::bad_alloc&) {
  return fail(
      Error{.code = ErrorCode::OutOfMemory, .what = "no memory for the report", .place = {.file = file}});
}

}  // namespace planish
