#include <fmt/core.h>

#include "app/commands.hpp"
#include "app/featured.hpp"
#include "app/provenance.hpp"
#include "io/feature_picture.hpp"
#include "io/file.hpp"
#include "io/mesh_files.hpp"
#include "io/report_json.hpp"

namespace planish {
namespace {

void print_features(const FeaturedMesh& featured) {
  const Embedding& embedding = *featured.embedding;
  for (const Feature& feature : embedding.features) {
    if (feature.is_region()) {
      fmt::print("{}: {} triangles\n", feature.name, feature.triangle.size());
    } else {
      fmt::print("{}: {} vertices, {}, length {:.6g}, deviation {:.3g}\n", feature.name,
                 feature.vertex.size(), feature.closed ? "closed" : "open", feature.length,
                 feature.max_deviation);
    }
  }
  fmt::print(
      "{} features in {} triangles: {} vertices and {} triangles added, {} points snapped, {} edges split "
      "for "
      "feasibility\n",
      embedding.features.size(), featured.input.mesh.num_triangles(), embedding.vertex_origin.size(),
      embedding.surface().num_triangles() - featured.input.mesh.num_triangles(), embedding.snapped_points,
      embedding.feasibility_splits);
}

}  // namespace

Result<int> run_embed(const CommonArgs& common, const EmbedArgs& args) {
  const OutputFile mesh_file{args.output, {"ply", "obj"}}, picture{args.picture, {"png", "svg"}},
      report{args.report, {}};
  if (auto possible = check_outputs({mesh_file, picture, report}); !possible) return fail(possible.error());
  const Exec exec(common.threads);
  ProgressLine progress(progress_style(common));
  Stopwatch stopwatch;
  const auto featured =
      read_featured(exec, args.mesh, args.constraints, args.repair, monitor_of(progress), stopwatch);
  if (!featured) return fail(featured.error());
  if (!featured->embedding) {
    Error error{.code = ErrorCode::ConstraintInvalid, .what = "there are no features to embed"};
    error.place = {.file = args.constraints, .pointer = "/features"};
    return fail(error);
  }
  const Embedding& embedding = *featured->embedding;
  std::vector<std::string> warnings = featured->mesh.warnings;
  auto written = stopwatch(Phase::Write, [&]() -> Result<void> {
    progress.show({.phase = Phase::Write});
    if (!args.output.empty()) {
      const Provenance provenance = provenance_of(featured->input, &embedding);
      auto done = write_mesh(exec, args.output,
                             {.mesh = &featured->mesh,
                              .triangle_origin = provenance.triangle_origin,
                              .vertex_origin_triangle = provenance.vertex_origin_triangle,
                              .vertex_barycentric = provenance.vertex_barycentric,
                              .features = &embedding.features},
                             warnings);
      if (!done) return done;
    }
    if (args.picture.empty()) return {};
    return write_feature_picture(exec, args.picture, embedding.surface(), embedding.features,
                                 {.title = file_name(args.mesh)});
  });
  if (!written) return fail(written.error());
  if (!args.report.empty()) {
    auto done =
        write_file(args.report, embed_report_json(embedding, {.input = args.mesh,
                                                              .command = common.command_line,
                                                              .mendings = featured->input.mendings,
                                                              .warnings = warnings,
                                                              .extra_timings = stopwatch.times(),
                                                              .peak_memory_bytes = peak_memory_bytes()}));
    if (!done) return fail(done.error());
  }
  progress.finish();
  say_warnings(common, warnings);
  if (!common.quiet) {
    say_mendings(featured->input.mendings);
    print_features(*featured);
  }
  return 0;
}

}  // namespace planish
